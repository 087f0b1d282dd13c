// SPDX-License-Identifier: GPL-3.0-or-later
//
// A layer of resin from profiles that were measured: radial samples at even distances and, where they were taken, the
// albedos that the samples are scaled to (Hasan et al. 2010, Sec. 4).
//
// T and R may have spacings and lengths of their own: both become coefficients of one grid. Samples below zero are
// noise about zero; they stay in the integral, where they cancel against as many above, and only coefficients are
// clamped. What lies beyond the last sample is not added: the summary says how much it may be, from the exponential
// through the last third of the samples.
#pragma once

#include <optional>
#include <vector>

#include "optics/numerics/hankel.h"
#include "optics/profiles/layer_profile.h"

namespace voxtone::optics {

/// Sample i lies at i * spacing; any unit of light per area where the total is given, else light per mm^2 of one unit
/// that entered.
struct RadialSamples {
    double spacing_mm = 0;
    std::vector<double> light;
    std::optional<double> total{};  ///< measured albedo, in [0, 1]
    std::vector<double> error{};    ///< standard error of each sample, in the unit of `light`; empty: not known
};

struct MeasuredProfile {
    double thickness_mm = 0;
    RadialSamples T, R;
};

struct MeasuredSummary {
    double T_total = 0, R_total = 0;        ///< before anything is clamped
    double negative_T = 0, negative_R = 0;  ///< light of samples below zero / light of all, as absolute values
    double beyond_T = 0, beyond_R = 0;      ///< estimated share beyond the last sample; 1 where samples do not fall off
    double clamped = 0;                     ///< largest change of a coefficient (layer_profile.h)
};

/// Throws InputError that names the profile, the value and the rule it breaks: thickness and spacing above 0, at least
/// four samples, all finite, light in all above 0 where it is to be scaled, totals in [0, 1], T + R at most 1.02
/// (beyond that it is no noise).
[[nodiscard]] HomogeneousLayer measured_layer(const MeasuredProfile& measured, const HankelGrid& grid,
                                              MeasuredSummary& summary);

/// A reflection profile by itself, as a surface is wanted to show it: its coefficients, not clamped; the summary has
/// its share of R. Throws InputError as above, also for more than 1.02 in all.
[[nodiscard]] std::vector<double> measured_reflection(const RadialSamples& R, const HankelGrid& grid,
                                                      MeasuredSummary& summary);

}  // namespace voxtone::optics
