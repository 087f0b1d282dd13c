// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a printed slab looks like beside what was asked for: Monte Carlo of the voxels of the finished stack, read back
// from its files, media-relative to Monte Carlo of the same slab all of white.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "optics/scene/appearance_model.h"
#include "slicer/options/slice_options.h"

namespace voxtone::loop_benchmark {

using Colours = std::vector<Eigen::Vector3f>;  ///< per cell, linear sRGB

struct Judgement {
    optics::Surface surface;
    std::size_t columns = 0, rows = 0;  ///< of flat slabs: cell = row * columns + column, rows along +y
    Colours target;
    std::array<Colours, 2> half;     ///< of the print, from independent paths
    std::vector<char> in_gamut;      ///< of the target: a flat print of 1 mm of colour shows it within 1 CIEDE2000
    Colours mapped;                  ///< the target as a flat print of 1 mm of colour shows it: beyond the gamut mapped
    std::vector<float> white_share;  ///< of the voxels to white_depth_mm under the cell
    double trace_seconds = 0;
    [[nodiscard]] Colours print() const;  ///< mean of the halves
};

inline constexpr double white_depth_mm = 0.4;  ///< most of what is seen

struct Effort {
    std::uint32_t paths = 128;       ///< per cell, channel and half
    std::uint32_t white_paths = 64;  ///< per cell and channel of the white twin
    double cell_mm = 0.085;
    std::filesystem::path cache;
};

/// `options`: those that the stack in options.out was made with.
[[nodiscard]] Judgement judge_slab(const slicer::SliceOptions& options, const Effort& effort);

/// Fills `in_gamut` and `mapped` from the target, by the separation of the job; `picture_thickness_mm`: nothing: a
/// body.
void map_target(const slicer::SliceOptions& options, std::optional<double> picture_thickness_mm, Judgement& j);

}  // namespace voxtone::loop_benchmark
