// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a laminate of resin layers reflects and transmits, channel by channel, as Hankel coefficients, by Monte Carlo of
// the whole laminate; layer by layer in all directions: wave_laminates.h.
//
// The two ways share nothing but the resins: their difference is the error of both, and what a set's own indices and
// phase functions do, which only light paths know: at the ends and between layers.
//
// One unit is the light that the top let in; T is what leaves at the bottom, or what a sheet there keeps.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/media/resins.h"
#include "optics/monte_carlo/layer_paths.h"
#include "optics/numerics/hankel.h"

namespace voxtone::optics {

struct ResinLayer {
    std::size_t resin = 0;  ///< index in the set
    double thickness_mm = 0;
};

/// What a laminate borders on. Below lies air beyond a surface (eta_bottom > 1), or a sheet in contact.
struct LaminateEnds {
    double eta_top = 1, eta_bottom = 1;  ///< 1: index-matched
    double sheet = 0;                    ///< share that a diffuse sheet in contact below sends back where it arrives
};

/// Coefficients by channel.
struct LaminateLight {
    std::vector<std::vector<double>> R, T;
    std::vector<double> R_error, T_error;  ///< standard errors of the first coefficients; 0 where none is known
};

/// Contract: at least one layer, thicknesses > 0, resins of the set; a sheet needs eta_bottom 1.
[[nodiscard]] LaminateLight traced_light(const ResinSet& set, std::span<const ResinLayer> layers,
                                         const LaminateEnds& ends, const HankelGrid& grid,
                                         const LayerPathOptions& options = {}, const Progress* progress = nullptr);

/// The radius that this share of the light stays within, mm; `reach_mm` at most.
[[nodiscard]] double radius_of_share(const HankelGrid& grid, std::span<const double> coefficients, double share);

}  // namespace voxtone::optics
