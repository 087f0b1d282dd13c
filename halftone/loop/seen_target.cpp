// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/seen_target.h"

#include <optional>
#include <utility>

#include "base/parallel.h"

namespace voxtone::halftone {

std::shared_ptr<const SeenTarget> see_target(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                                             double viewing_distance_mm) {
    std::optional<EyeFilter> eye;
    std::vector<ColourRegion> regions;
    // Regions are found by one thread.
    parallel_for(0, 2, 1, [&](std::size_t task) {
        if (task == 0)
            regions = colour_regions(surface, target);
        else
            eye.emplace(surface, viewing_distance_mm, EyeSurround::none);
    });
    return std::make_shared<const SeenTarget>(*std::move(eye), std::move(regions));
}

}  // namespace voxtone::halftone
