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

struct LaminateSearchOptions {
    double thickness_mm = 5;       ///< most thickness of a laminate, above 0
    std::uint32_t steps = 64;      ///< of thickness, [1, 4096]
    std::uint32_t max_blocks = 6;  ///< [1, 16]
    double dc_weight = 1;          ///< above 0
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
