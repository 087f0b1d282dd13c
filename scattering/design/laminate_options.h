// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a laminate search is asked for, and the values that its parts hand to one another (laminate_search.h says what
// they mean together). mm; layers from the top; profiles are Hankel coefficients, the first one the total
// (optics/profiles/layer_profile.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "optics/profiles/layer_profile.h"

namespace voxtone::scattering {

/// One material, by channel; every channel has as many coefficients.
using LaminateMaterial = std::vector<optics::HomogeneousLayer>;
/// Reflection profile to be shown, or of a backing: Hankel coefficients by channel.
using ChannelProfiles = std::vector<std::vector<double>>;

/// What coefficients count in a distance (laminate_search.h).
struct ProfileWeights {
    double first = 1;  ///< the total
    /// The others fall like 1 / k^2, relative to the first wave: the difference of what is seen beyond the edge of a
    /// shadow, where a wave of k in the profile is one of k over k (a border is lit by all distances); else all are 1.
    bool edge = false;

    ProfileWeights(double of_total = 1, bool of_edge = false)
        : first(of_total), edge(of_edge) {}  // NOLINT: a number is one
    [[nodiscard]] double of(std::size_t coefficient) const {
        if (coefficient == 0) return first;
        if (!edge) return 1;
        const double zero = 1.25 / (static_cast<double>(coefficient) + 0.25);  // k_1 / k_i: zeros of J1
        return zero * zero;
    }
    [[nodiscard]] double sum(std::size_t coefficients) const {
        double all = 0;
        for (std::size_t i = 0; i < coefficients; ++i) all += of(i);
        return all;
    }
};

struct LaminateSearchOptions {
    double thickness_mm = 5;       ///< most thickness of a laminate, above 0
    std::uint32_t steps = 64;      ///< of thickness, [1, 4096]
    std::uint32_t max_blocks = 6;  ///< [1, 16]
    double dc_weight = 1;          ///< above 0
    bool edge_weights = false;     ///< of the other coefficients
    [[nodiscard]] ProfileWeights weights() const { return {dc_weight, edge_weights}; }
    /// By material: it stays that far from the top (rounded up to steps); empty: no limits.
    std::vector<double> clear_top_mm;
    ChannelProfiles backing;  ///< empty: black
    double tolerance = 1e-5;  ///< how much nearer than the result another laminate may be, at most; >= 0
    /// Most sub-laminates in a table. More cost more to prepare and less for each target; the result stays within
    /// `tolerance`.
    std::uint32_t table_laminates = 12000;
};

struct LaminateLayer {
    std::size_t material;
    double thickness_mm;
};

struct SearchCount {
    std::uint64_t visited = 0;  ///< partial laminates and groups of sub-laminates that were opened
    std::uint64_t pruned = 0;   ///< of these, and of whole laminates, those that a bound put aside unopened
    std::uint64_t judged = 0;   ///< whole laminates that were compared in double precision
};

}  // namespace voxtone::scattering
