// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heterogeneous slabs of known mixtures: what data sets of scattering are made of where nothing is measured.
//
//   chess   squares: white over black, and a deep translucent body
//   marble  a light translucent body with darker, warmer veins that run slantwise through it (turbulence of lattice
//           noise; K. Perlin, "An image synthesizer", SIGGRAPH 1985)
//   stone   grains, each of one translucency and tint (cells of the nearest seed point; S. Worley, "A cellular texture
//           basis function", SIGGRAPH 1996)
//
// Mixtures are ideal ones of the roles W, K and T (clear), with C, M and Y as tints where the set has them. A slab is a
// function of the place in mm, so margins go on as the pattern does. Depth counts from the top.
#pragma once

#include <array>
#include <cstdint>

#include "optics/media/resin_volume.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

enum class SlabPattern { chess, marble, stone };

struct SlabOptions {
    SlabPattern pattern = SlabPattern::marble;
    std::uint32_t width = 64, height = 64;  ///< columns, one per point
    std::uint32_t margin = 12;              ///< more columns at every side
    double pitch_mm = 0.5;
    double thickness_mm = 4;
    double layer_mm = 0.2;  ///< depth of a voxel; the thickness is rounded to whole ones
    double feature_mm = 4;  ///< edge of a square, distance of veins, size of grains
    std::uint64_t seed = 1;
    /// Throws InputError that names the value and the rule it breaks.
    void validate() const;
};

/// Mixtures as resins of their own: material m of the volume is mixtures.resins[m - 1].
struct MixtureSlab {
    ResinSet mixtures;
    ResinVolume volume;
};

/// Throws InputError for options out of range and for a resin set without W, K or T.
[[nodiscard]] MixtureSlab make_slab(const ResinSet& resins, const SlabOptions& options);

}  // namespace voxtone::optics
