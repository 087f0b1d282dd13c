// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a wanted reflection to a laminate to print: search, refinement, whole printed layers, and correction by a better
// model.
//
// The search (laminate_search.h) laminates index-matched layers. What the print shows differs: a surface turns light
// back, light between layers is not diffuse, layers have other thicknesses than those they are known at. So its target
// is corrected. With g(seen) = seen / (1 - s + s seen) what lies behind a surface that turns back s (saunderson.h),
//
//   target_0 = g(wanted),   target_n+1 = g(wanted) + R_model(laminate_n) - g(R_judged(laminate_n))
//
// for every coefficient: what the model must say of a laminate for the judge to see what is wanted, as far as their
// difference stays the same from one laminate to the next. It does where laminates are alike; so in each round one
// laminate is searched and its thicknesses are then refined several times, each time with the difference at the
// laminate itself. The judge is whatever knows more (all directions: optics/profiles/wave_laminates.h). The laminate
// that the judge finds nearest is kept, so rounds never make it worse.
//
// What it cannot see: laminates whose error differs a lot from that of the ones that were judged.
#pragma once

#include <functional>

#include "scattering/design/laminate_search.h"

namespace voxtone::scattering {

/// What a laminate reflects, by channel; layers may be none.
using LaminateJudge = std::function<ChannelProfiles(std::span<const LaminateLayer>)>;

struct LaminateDesignOptions {
    LaminateSearchOptions search;  ///< as the search was made with
    bool refine = true;            ///< thicknesses between the steps
    double turned_back = 0;        ///< s: share of diffuse light that the surface turns back; in [0, 1)
    double layer_mm = 0;           ///< of the printer: whole_layers.h; 0: any thickness
    int rounds = 2;                ///< searches, >= 1; without a judge there is one
    int corrections = 3;  ///< of the thicknesses in each round, >= 0; none without a judge or without refinement
};

struct LaminateDesign {
    std::vector<LaminateLayer> layers;  ///< to print
    ChannelProfiles modelled;           ///< its R by the model, through the surface
    double modelled_distance = 0;       ///< from what is wanted (laminate_search.h); through the surface too
    ChannelProfiles judged;             ///< empty without a judge
    double judged_distance = 0;
    FoundLaminate found;  ///< the search that it came from
    double outside = 0;   ///< of the first search: how far its target lies outside of the gamut, at least
    std::vector<double> judged_distances;  ///< of all that were judged, in order
};

/// Throws as LaminateSearch::find and refine_laminate.
[[nodiscard]] LaminateDesign design_laminate(const LaminateSearch& search, std::span<const LaminateMaterial> materials,
                                             const ChannelProfiles& wanted, const LaminateDesignOptions& options,
                                             const LaminateJudge& judge = {});

}  // namespace voxtone::scattering
