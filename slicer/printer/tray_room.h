// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether something fits a printer's tray. What is exactly as long as the tray fits it: its last voxel is cut short by
// the tray's end where that is no whole number of voxels. A micrometre more fits too: a model's single-precision
// coordinates and the digits of a plan are no better.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/core.h>

namespace voxtone::slicer {

inline constexpr double tray_slack_mm = 1e-3;

[[nodiscard]] inline bool fits_in(double mm, double room_mm) { return mm <= room_mm + tray_slack_mm; }

/// Voxels of what is as long as the room, as grid_around (placement.h) counts them.
[[nodiscard]] inline int voxels_in(double room_mm, double pitch_mm) {
    constexpr double most = std::numeric_limits<int>::max() / 2;
    return static_cast<int>(std::min(most, std::ceil((room_mm + tray_slack_mm) / pitch_mm - 1e-6)));
}

/// How much is too much: "10 um", "3.25 mm".
[[nodiscard]] inline std::string excess_text(double mm) {
    return mm < 1 ? fmt::format("{:.3g} um", mm * 1e3) : mm < 1e3 ? fmt::format("{:.3g} mm", mm) : "over 1 m";
}

}  // namespace voxtone::slicer
