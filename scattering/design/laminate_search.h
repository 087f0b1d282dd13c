// SPDX-License-Identifier: GPL-3.0-or-later
//
// The laminate of layers whose reflection profile is nearest to a wanted one.
// Based on: M. Hasan, M. Fuchs, W. Matusik, H. Pfister, S. Rusinkiewicz, "Physical reproduction of materials with
// specified subsurface scattering", SIGGRAPH 2010, Sec. 6.
//
// What is searched: sequences of blocks, a block being one material of 1, 2, 4, ... steps of thickness_mm / steps, at
// most `max_blocks` of them and `steps` steps in all, the first block on top. A layer of one material is a run of
// blocks of falling thickness, so each laminate is met once. Below the laminate, wherever it ends, comes the backing:
// black, or what is given.
//
// What is minimised: the weighted root mean square of the residual of the reflection's Hankel coefficients over all
// channels, sqrt(sum w (R - R_target)^2 / sum w), w = dc_weight at the first coefficient of each channel and 1
// elsewhere: the paper's L2 norm on a scale that does not grow with the number of coefficients.
//
// How: iterative deepening over the number of blocks d; for each d depth-first from the top, promising blocks first,
// branch and bound. The last blocks are not searched one by one: all sub-laminates of up to `table_blocks()` blocks lie
// in trees of boxes in the space of coefficients, made once for all targets. Bounds, all of them per coefficient and
// provable:
// - Reflection from above only grows with reflection from below (Eq. 6 has no negative term). The paper puts 0 (too
//   bright) and 1 (too dark) below a partial laminate. Here the least and the most go there that exactly the blocks
//   left, within the thickness left, starting with the block in question, can reflect at each coefficient by themselves
//   (dynamic programming, laminate_bounds.h). Coefficients that are too bright and such that are too dark add up; the
//   paper takes the larger of both sums.
// - A tree node stands for many sub-laminates; the box of their coefficients bounds them all in the same way.
// - Sums of squares stop at the bound, less what the coefficients to come add at least, whatever lies below; those that
//   differ most between materials come first.
//
// The trees and bounds are single precision; a residual is wrong there by at most 4e-6. What passes is judged in double
// precision. Nothing is cut that could be better than the result by more than `tolerance` (0: by anything): the margin
// of rounding is allowed for. Below a tolerance of about 5e-6 all laminates that tie within rounding are judged one by
// one: where light does not reach the lower layers there are thousands, and the search is slow. The result, its counts
// included, has the same bits for any number of threads and any company of targets.
//
// What it cannot see: blocks of other sizes (laminate_refinement.h), and everything that profiles cannot
// (layer_profile.h).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

/// Of one channel.
struct ChannelMatch {
    double target_total, found_total;  ///< DC coefficients
    double least_total, most_total;    ///< of any laminate that is searched
    /// Mean of all coefficients over the DC one: smaller where light spreads wider.
    double target_spread, found_spread;
};

struct FoundLaminate {
    std::vector<LaminateLayer>
        layers;           ///< from the top; neighbours differ in material; empty: the backing alone is best
    double distance = 0;  ///< see above; for a target outside of the gamut: the distance to it, to within `tolerance`
    /// No laminate of these materials, blocks and thickness can be nearer; above 0: outside of the gamut.
    double outside = 0;
    std::vector<ChannelMatch> channels;
    SearchCount count;
};

class LaminateSearch {
public:
    /// Prepares tables. InputError for no material, channels or lengths that differ, options out of range.
    LaminateSearch(std::span<const LaminateMaterial> materials, const LaminateSearchOptions& options);
    ~LaminateSearch();
    LaminateSearch(LaminateSearch&&) noexcept;
    LaminateSearch& operator=(LaminateSearch&&) noexcept;

    /// InputError for a target of other length or with values that are not finite.
    [[nodiscard]] FoundLaminate find(const ChannelProfiles& target) const;
    /// Several at once, in parallel.
    [[nodiscard]] std::vector<FoundLaminate> find_all(std::span<const ChannelProfiles> targets,
                                                      const Progress* progress = nullptr) const;

    /// How many laminates there are to choose from, the empty one included.
    [[nodiscard]] double laminates() const;
    /// Blocks of the longest sub-laminates in tables.
    [[nodiscard]] std::uint32_t table_blocks() const;

private:
    struct Tables;
    std::unique_ptr<const Tables> tables_;
};

/// What a laminate over a backing reflects (empty backing: black), and how far that is from a target, by the
/// measure above.
[[nodiscard]] ChannelProfiles laminate_reflection(std::span<const LaminateMaterial> materials,
                                                  std::span<const LaminateLayer> layers,
                                                  const ChannelProfiles& backing);
[[nodiscard]] double profile_distance(const ChannelProfiles& reflection, const ChannelProfiles& target,
                                      const ProfileWeights& weights);

}  // namespace voxtone::scattering
