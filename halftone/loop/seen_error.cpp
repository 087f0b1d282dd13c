// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/loop/seen_error.h"

#include "voxtone/base/parallel.h"
#include "voxtone/optics/scene/area_summary.h"

namespace voxtone::halftone {

SeenError::SeenError(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                     const std::vector<char>& counts, double viewing_distance_mm)
    : surface_(surface),
      eye_(surface, viewing_distance_mm, EyeSurround::none),
      target_(target),
      seen_target_(eye_.filter(target)),
      counts_(counts) {}

optics::DifferenceSummary SeenError::of_cells(std::span<const Eigen::Vector3f> rgb) const {
    return summary(target_, rgb);
}

optics::DifferenceSummary SeenError::as_seen(std::span<const Eigen::Vector3f> seen) const {
    return summary(seen_target_, seen);
}

optics::DifferenceSummary SeenError::summary(std::span<const Eigen::Vector3f> target,
                                             std::span<const Eigen::Vector3f> rgb) const {
    std::vector<double> difference(target.size());
    parallel_for(0, target.size(), 1024, [&](std::size_t i) {
        const auto lab = [](const Eigen::Vector3f& v) {
            return optics::lab_from_linear_srgb(v.cast<double>().cwiseMax(0));
        };
        difference[i] = counts_[i] ? optics::ciede2000(lab(target[i]), lab(rgb[i])) : 0;
    });
    return optics::summarize_by_area(surface_, difference, counts_);
}

}  // namespace voxtone::halftone
