// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a print is from its target, for the report and for the choice of the best iterate: CIEDE2000 cell by cell,
// weighed by area, as predicted and after the eye filter (eye_filter.h, without its negative surround). What the loop
// goes downhill on is another measure (misfit.h).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "voxtone/halftone/loop/eye_filter.h"
#include "voxtone/optics/colour/colour.h"
#include "voxtone/optics/scene/appearance_model.h"

namespace voxtone::halftone {

class SeenError {
public:
    /// Keeps references. `counts`: per cell, whether its error counts.
    SeenError(const optics::Surface& surface, std::span<const Eigen::Vector3f> target, const std::vector<char>& counts,
              double viewing_distance_mm);

    /// Colours are linear sRGB per cell.
    [[nodiscard]] optics::DifferenceSummary of_cells(std::span<const Eigen::Vector3f> rgb) const;
    /// `seen`: what the eye filter leaves of the print (eye().filter).
    [[nodiscard]] optics::DifferenceSummary as_seen(std::span<const Eigen::Vector3f> seen) const;

    [[nodiscard]] const EyeFilter& eye() const { return eye_; }

private:
    [[nodiscard]] optics::DifferenceSummary summary(std::span<const Eigen::Vector3f> target,
                                                    std::span<const Eigen::Vector3f> rgb) const;

    const optics::Surface& surface_;
    EyeFilter eye_;
    std::span<const Eigen::Vector3f> target_;
    std::vector<Eigen::Vector3f> seen_target_;
    const std::vector<char>& counts_;
};

}  // namespace voxtone::halftone
