// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slabs of one colour each: does a flat colour come out as it was asked for?
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "judge_slab.h"

namespace voxtone::loop_benchmark {

inline constexpr double flat_mm = 8;  ///< edge of a slab; judged are the 4 mm in its middle

struct FlatTarget {
    std::filesystem::path picture;  ///< PNG in the work folder
    Eigen::Vector3f rgb;            ///< linear sRGB
};

/// Greys and muted hues, all in the gamut of Vero Opaque.
[[nodiscard]] std::vector<FlatTarget> flat_targets(const std::filesystem::path& work);

struct FlatRow {
    Eigen::Vector3f rgb;
    std::array<double, 2> difference{};  ///< CIEDE2000 of the mean colour, open loop and loop
    double noise = 0;                    ///< of the loop's: that of the tracer's two halves from each other / 2
};

void judge_flat(const Judgement& judged, std::size_t way, FlatRow& row);
[[nodiscard]] std::string flat_table(const std::vector<FlatRow>& rows);

}  // namespace voxtone::loop_benchmark
