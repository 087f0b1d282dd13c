// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colour differences between print and target, with what the tracer's noise adds taken out as far as two independent
// halves allow.
//
// With M the mean of the halves and M1, M2 the halves, a figure F (mean, median, 95th percentile of CIEDE2000) of M has
// half the noise variance of that of M1 or M2. Straight on to no noise: F = 2 F(M) - (F(M1) + F(M2)) / 2. That is exact
// where the noise is small against the error (its effect is then linear in its variance) and too large, by 0.41 of a
// half's noise, where there is nothing but noise: never flattering. Figures are not less than 0. `noise` is the mean of
// F(M1, M2) / 2: what the noise left in M looks like. A cell has nothing more to give where it is seen too dark
// although 98 % of its voxels are white, or too light although 98 % are not. Differences are of linear sRGB clamped
// from below at 0.
#pragma once

#include <span>

#include "halftone/loop/eye_filter.h"
#include "judge_slab.h"

namespace voxtone::loop_benchmark {

struct Figures {
    double mean = 0, median = 0, percentile_95 = 0, noise = 0;
    std::size_t cells = 0;
};

struct Scores {
    Figures cells_in_gamut, cells_all;  ///< cell by cell
    Figures eye_in_gamut, eye_all;      ///< print and target both behind the eye filter, colour smoothed as light
    Figures eye_reachable;      ///< cells in the gamut, what surrounds them mapped into it: the filter mixes them
    Figures eye_mapped;         ///< all cells, the target mapped into the gamut
    Figures seen_in_gamut;      ///< colour smoothed as it is perceived: as the program says it
    Figures s_cielab_in_gamut;  ///< the same in the published opponent channels, in which white is not neutral
    double at_limit = 0;        ///< share of eye_in_gamut's sum in cells that have nothing more to give
    double contrast_kept = 0;   ///< of the in-gamut cells, as seen
    double paper = 0;           ///< mean CIEDE2000 as seen where the target is seen as white; 0: nowhere
};

inline constexpr double fine_mm = 0.8;

/// How much of the target's fine contrast the print has: the slope of its L* against the target's, both less their mean
/// over a Gaussian exp(-(r / fine_mm)^2). Noise of the print does not bias it. 0 where the target has none.
[[nodiscard]] double contrast_kept(const optics::Surface& surface, const Colours& target, const Colours& print,
                                   std::span<const char> mask);

/// Of the cells whose mask is not 0; empty: of all.
[[nodiscard]] Figures compare(const Colours& target, const std::array<Colours, 2>& half, std::span<const char> mask);

struct Eye {
    Eye(const optics::Surface& surface, double distance_mm)
        : as_light(surface, distance_mm, halftone::EyeSurround::none, halftone::OpponentSpace::neutral),
          seen(surface, distance_mm),
          s_cielab(surface, distance_mm, halftone::EyeSurround::published, halftone::OpponentSpace::published) {}
    halftone::EyeFilter as_light, seen, s_cielab;
};
[[nodiscard]] Scores score(const Judgement& j, const Eye& eye);

/// CIEDE2000 per cell, of the mean of the halves.
[[nodiscard]] std::vector<double> differences(const Colours& a, const Colours& b);

}  // namespace voxtone::loop_benchmark
