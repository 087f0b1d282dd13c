// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a target is seen by, found once: the loop measures its prints with it, and the verdict the last one.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/colour_regions.h"
#include "halftone/loop/eye_filter.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

struct SeenTarget {
    EyeFilter eye;  ///< without its negative surround
    std::vector<ColourRegion> regions;
};

/// `target`: linear sRGB per cell.
[[nodiscard]] std::shared_ptr<const SeenTarget> see_target(const optics::Surface& surface,
                                                           std::span<const Eigen::Vector3f> target,
                                                           double viewing_distance_mm);

}  // namespace voxtone::halftone
