// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far sideways light leaves a laminate from where it entered: the reference of layered profiles, by Monte
// Carlo.
//
// Layers are endless, of one phase function or each of its own; where neighbours differ in index, their border, which
// is flat, reflects and refracts as Fresnel says. Air may lie beyond smooth surfaces at the top and at the bottom, or a
// diffuse sheet may be glued to the bottom (what it sends back is lambertian; T is what it keeps). Paths enter at one
// point of the top from diffuse light that the surface lets in and are those of scalar_paths.h: free paths by optical
// depth, Henyey-Greenstein, the weight times the albedo at every scattering, roulette below `default_roulette_weight`.
// What leaves is counted by its distance in rings: as many units of 2^-32, so that the sums have the same bits for any
// number of threads. Light that entered is 1.
//
// Error: noise, and light is spread evenly over its ring. Rings are reach / (16 n) wide, which takes less than 0.2 %
// off the highest of n Hankel coefficients.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/media/resins.h"
#include "optics/numerics/hankel.h"

namespace voxtone::optics {

struct PlainLayer {
    Medium medium;
    double thickness_mm = 0;
    std::optional<double> g = std::nullopt;  ///< nothing: the scene's
    double eta = 1;                          ///< of neighbours only the ratio counts
};

/// Top first.
struct LayerScene {
    std::vector<PlainLayer> layers;
    double g = 0.4;
    double eta_top = 1, eta_bottom = 1;  ///< at the ends; 1: index-matched, what leaves does not come back
    double backing = 0;                  ///< share that a diffuse sheet in contact below sends back; needs eta_bottom 1
};

struct LayerPathOptions {
    std::uint32_t paths = 1 << 18;
    std::uint64_t seed = 1;
};

/// Light that left, by distance.
struct RingLight {
    std::vector<double> light;  ///< per ring
    double total = 0, standard_error = 0;
};

struct TracedProfile {
    std::vector<double> edges_mm;  ///< of the rings; what left beyond the last edge is counted in the last ring
    RingLight R, T;                ///< scattered, or turned back by a surface
    RingLight T_direct;            ///< straight through
};

/// Edges of the rings: even up to the grid's reach, then ever wider to 8 times the reach.
[[nodiscard]] std::vector<double> ring_edges(const HankelGrid& grid);

/// Contract: layers of thickness > 0, finite, sigma >= 0, |g| < 1, eta >= 1, backing in [0, 1].
[[nodiscard]] TracedProfile trace_layers(const LayerScene& scene, const HankelGrid& grid,
                                         const LayerPathOptions& options = {}, const Progress* progress = nullptr);

}  // namespace voxtone::optics
