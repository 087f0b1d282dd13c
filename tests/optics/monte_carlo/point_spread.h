// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far from where it entered light leaves a print, traced voxel by voxel: R(r) of a body that need not be made of
// plane layers, as the mean over points that are spread evenly over a part of its top (the camera of Hasan et al. 2010,
// Sec. 4, averages so over the dither).
//
// Every unit of light that the surface let in is diffuse, as everywhere here. Of `total`, light[i] left at the top
// between edges_mm[i] and edges_mm[i + 1] of its entry; what went farther is counted in the last ring. Mirrored sides
// fold far light back: keep the entries as far from the sides as light is to be told apart.
//
// The judge of printed voxels where profiles of layers (optics/profiles) are compared with what their screened print
// does (benchmarks/scattering/jobs/widening_experiment.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/monte_carlo/layer_paths.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics::testing {

struct PointSpreadOptions {
    std::array<int, 2> first{}, end{};  ///< columns of voxels where light enters: x and y in [first, end)
    std::vector<double> edges_mm;       ///< of the rings, ascending from 0
    std::uint32_t paths = 1u << 17;     ///< per channel, >= 2
    std::uint64_t seed = 1;
};

/// Of each channel. Contract: entries lie on resin at the flat top of the volume; two edges at least. The same bits for
/// any number of threads.
[[nodiscard]] std::vector<RingLight> trace_point_spread(const Scene& scene, const PointSpreadOptions& options,
                                                        const Progress* progress = nullptr);

/// Within this distance a share of the light left; linear between the edges.
[[nodiscard]] double radius_of_share(const RingLight& rings, std::span<const double> edges_mm, double share);

}  // namespace voxtone::optics::testing
