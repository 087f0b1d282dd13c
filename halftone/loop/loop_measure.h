// SPDX-License-Identifier: GPL-3.0-or-later
//
// How good a print is, for the choice of the best iterate and for what the descent counts more: as a person would say
// who sees regions (colour_regions.h) and takes the print's own paper for white (paper.h).
//
//   score = sum a_i v_i d_i / sum a_i v_i  +  sum_r A_r v_r max(0, b_r - 0.25) / sum a_i v_i
//
// d_i is the CIEDE2000 of cell i after the eye filter (eye_filter.h, without its negative surround), the print over its
// paper's level against the target as the resins can show it; a_i, A_r areas; v = sqrt(A_largest / A_r), at most 4, of
// cells in a region, 1 of others, 0 of those in none whose target lies out of the gamut. b_r is by how much a region is
// worse than in the open loop (worse_by), which nobody sees up to 0.25: it is counted besides.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/colour_regions.h"
#include "halftone/loop/eye_filter.h"
#include "halftone/loop/seen_target.h"
#include "optics/colour/colour.h"

namespace voxtone::halftone {

class LoopMeasure {
public:
    /// Keeps references. `shown`: as the resins can show it. `adapts`: the
    /// print's paper is taken for white; not where white is absolute.
    LoopMeasure(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                std::span<const Eigen::Vector3f> shown, const std::vector<char>& in_gamut, double viewing_distance_mm,
                bool adapts = true);

    struct Value {
        optics::DifferenceSummary seen;   ///< of all cells, against what was asked for, as seen, over the paper's level
        optics::DifferenceSummary cells;  ///< of cells as they are, not adapted
        double score = 0;
        float paper = 1;
        std::vector<RegionLook> looks;  ///< of regions
        EyeFilter::Views views;         ///< of the colours, not over the paper's level
    };
    /// `open`: of the open loop's regions; empty: this is the open loop.
    [[nodiscard]] Value operator()(std::span<const Eigen::Vector3f> rgb, std::span<const RegionLook> open) const;

    [[nodiscard]] const EyeFilter& eye() const { return seen_target_->eye; }
    [[nodiscard]] std::span<const ColourRegion> regions() const { return seen_target_->regions; }
    /// What was asked for.
    [[nodiscard]] const std::shared_ptr<const SeenTarget>& seen_target() const { return seen_target_; }
    /// v of each cell, times its region's urgency: weights for the descent. Out of the gamut and in no region:
    /// `beyond`.
    [[nodiscard]] std::vector<float> weights(std::span<const float> urgency, float beyond) const;

private:
    [[nodiscard]] float weight_of(const ColourRegion& region) const;

    const optics::Surface& surface_;
    std::span<const Eigen::Vector3f> asked_;
    std::shared_ptr<const SeenTarget> seen_target_;
    std::vector<Eigen::Vector3f> lab_asked_, lab_seen_asked_, lab_seen_shown_;  ///< in single precision: 1e-5 of them
    std::vector<Eigen::Vector3f> near_asked_;
    const std::vector<char>& in_gamut_;
    bool adapts_;
    std::vector<float> weight_;
};

}  // namespace voxtone::halftone
