// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page of sine gratings, and how much of their modulation a print keeps.
//
// Columns: 0.5, 1, 2 line pairs per mm; rows: stripes that follow each other along x and along y, of mid contrast
// (linear light 0.4 +- 0.15: within the gamut) and of full contrast (0.5 +- 0.48: beyond it). Modulation is amplitude /
// mean of the luminance; "kept" is that of the print over that of the target, both by least squares of a constant, a
// sine and a cosine over the inside of a block. Only what is in phase with the target counts, so noise does not add to
// it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "optics/scene/appearance_model.h"

namespace voxtone::loop_benchmark {

struct GratingBlock {
    double x0, y0, x1, y1;  ///< mm; y points up
    double per_mm;          ///< line pairs
    int axis;               ///< 0: light changes along x
    bool full;              ///< contrast
};

[[nodiscard]] std::vector<GratingBlock> grating_blocks(double width_mm, double height_mm);
/// Linear light of the page.
[[nodiscard]] double grating_light(std::span<const GratingBlock> blocks, double x, double y);

/// Of one block; NaN where the inside is narrower than a period or than three cells.
[[nodiscard]] double modulation_kept(const GratingBlock& block, const optics::Surface& surface,
                                     std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> print);

inline constexpr std::array<double, 3> grating_frequencies{0.5, 1, 2};

/// Mean over both directions and both contrasts, per frequency.
[[nodiscard]] std::array<double, 3> modulation_by_frequency(double width_mm, double height_mm,
                                                            const optics::Surface& surface,
                                                            std::span<const Eigen::Vector3f> target,
                                                            std::span<const Eigen::Vector3f> print);

}  // namespace voxtone::loop_benchmark
