// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether something fits a printer's tray. What is exactly as long as the tray fits it, and its voxels do, which stand
// over the tray's ends by a quarter of one at most. A micrometre more fits too: a model's single-precision
// coordinates and the digits of a plan are no better.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include <fmt/core.h>

#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

inline constexpr double tray_slack_mm = 1e-3;

[[nodiscard]] inline bool fits_in(double mm, double room_mm) { return mm <= room_mm + tray_slack_mm; }

/// Voxels of what is as long as the room, which may have no end.
[[nodiscard]] inline int voxels_in_room(double room_mm, double pitch_mm) {
    constexpr int most = std::numeric_limits<int>::max() / 2;
    return room_mm / pitch_mm < most ? voxels_in(room_mm + tray_slack_mm, pitch_mm) : most;
}

/// How much is too much: "10 um", "3.25 mm".
[[nodiscard]] inline std::string excess_text(double mm) {
    return mm < 1 ? fmt::format("{:.3g} um", mm * 1e3) : mm < 1e3 ? fmt::format("{:.3g} mm", mm) : "over 1 m";
}

}  // namespace voxtone::slicer
