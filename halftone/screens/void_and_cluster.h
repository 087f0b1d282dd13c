// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ranks the voxels of a periodic cube so that those of rank < n lie evenly in space for every n: a blue-noise mask.
//
// Based on: R. Ulichney, "The void-and-cluster method for dither array generation", SPIE 1913 (1993), carried to three
// dimensions. The energy of a voxel is a sum over all marked voxels of
//
//   exp(-d^2 / (2 sigma^2)) + box_weight * (cubes of 16^3 voxels that hold both) / 16^3,
//
// d the distance in mm on the torus, so that the pattern is isotropic in millimetres although voxels are not. The
// second term is ours: its total over the marked voxels is the sum of squared counts over all cubes of 16^3 voxels, so
// that the same greedy steps keep those counts even. The worst error of any interval of ranks in any cube of 4096
// voxels, on the J750's pitch: 50 voxels (1.2 %) without it, 32 (0.78 %) with it; white noise 170.
//
// A random tenth is marked and relaxed (the tightest cluster moves into the largest void until it would move back),
// then unmarked cluster by cluster (ranks downward) and filled void by void (ranks upward). With a linear filter the
// method's third phase equals the second. Energies are integers: sums do not drift, and the ranks are the same bits
// everywhere. No library makes such a mask in three dimensions with voxels of unequal sides and a bound on its counts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "halftone/screens/pattern_energy.h"

namespace voxtone::halftone {

struct VoidAndClusterOptions {
    std::array<double, 3> pitch_mm{1, 1, 1};  ///< of a voxel, > 0; only the ratios matter
    double sigma_pitches = 1.5;               ///< sigma in units of the cube root of a voxel's volume, in [0.5, 3]
    double box_weight = 0.1;                  ///< in [0, 1]
    std::uint64_t seed = 1;
};

/// Voxels along one edge of the cube.
inline constexpr int void_and_cluster_size = 64;

/// rank[x + 64 (y + 64 z)]: a permutation of 0 .. 2^18 - 1. Along an axis whose voxels are so thin that sigma would be
/// more than 8 of them, sigma is 8 voxels (the tile is too short for more): isotropic up to pitch ratios of about 10.
[[nodiscard]] std::vector<std::uint32_t> void_and_cluster(const VoidAndClusterOptions& options,
                                                          const Progress* progress = nullptr);

/// The field of no marked voxel, of which the ranks are made; where all voxels are marked, an energy is 0.9 of a marked
/// voxel's offset, 2^30.
[[nodiscard]] PatternEnergy void_and_cluster_energy(const VoidAndClusterOptions& options);

/// The same as thresholds 0 .. 65534: rank / 4, the last four lowered by 1 (see blue_noise_screen.h).
[[nodiscard]] std::vector<std::uint16_t> void_and_cluster_thresholds(const VoidAndClusterOptions& options,
                                                                     const Progress* progress = nullptr);

}  // namespace voxtone::halftone
