// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a texture's contrast a print keeps: fur, feathers, cloth, the detail of a photograph.
//
//   t, p   Oklab's lightness of target and print behind the eye's narrowest Gaussian (halftone/loop/eye_filter.h), in a
//          room's light (job_prediction.h), each less its mean by a Gaussian twice as wide: what is as fine as the eye
//          can still see, some 1 to 3 lines a millimetre from 300 mm
//   S      a mean by a Gaussian four times as wide, 0.6 mm from there
//   c      = sqrt(S(t^2)), the contrast that is asked for
//   k      = max(0, S(t p) / S(t^2)), the part of it that the print has. Grain, which the target knows nothing of,
//          neither adds to it nor takes away
//
// It is lost where k < 1/2 and c (1 - k), what is missing, is 0.0075 or more, some 0.9 of L*. Where a quarter of what
// lies within twice S is of flat regions (halftone/loop/colour_regions.h) nothing is a texture: edges between them,
// type and lines are judged by themselves. The figures were chosen on img_kodim23 of 20 mm, open loop and loop, looked
// at as the eye sees them: the open loop is blurred over 36 % of it, the loop's print at the parrots' faces alone, 6 %.
// Means within a millimetre in the place of those of t and p let coarse edges, which every print has, hide that
// feathers are gone. A smaller print of the same is blurred over more of it (open loop: img_kodim23 of 5, 8, 12, 18, 27
// mm 100, 87, 60, 43, 30 %, img_marble of 5 to 27 mm 29 to 2 %, a banana of 8 to 27 mm 71 to 8 %), as long as the eye
// sees it. What it cannot see: texture of hue alone; detail that the target's own cells have already averaged.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/colour_regions.h"
#include "halftone/loop/eye_filter.h"
#include "optics/scene/surface.h"

namespace voxtone::slicer {

struct TextureLook {
    float asked = 0;  ///< c; 0 where it is no texture
    float kept = 1;   ///< k
    [[nodiscard]] bool is_lost() const { return kept < 0.5f && asked * (1 - kept) >= 0.0075f; }
};

/// Per cell. `near_target`, `near`: what the narrowest Gaussian leaves of target and print, linear sRGB with a room's
/// light over them; `regions`: of the target; `wide`: a mean as wide as 2 S. Time: that of two narrowest EyeFilters and
/// three `smoothed`.
[[nodiscard]] std::vector<TextureLook> look_at_texture(const optics::Surface& surface,
                                                       std::span<const Eigen::Vector3f> near_target,
                                                       std::span<const Eigen::Vector3f> near,
                                                       std::span<const halftone::ColourRegion> regions,
                                                       const halftone::EyeFilter& wide, double viewing_distance_mm);

struct LostTexture {
    std::vector<std::uint32_t> cells;  ///< ascending
    double area_mm2 = 0;
    double seen_share = 0;  ///< of all that is seen
    double kept = 0;        ///< of all their contrast
};

/// Nothing where it is less than a fiftieth of what is seen. `seen`: per cell, its area by how far it can be seen.
[[nodiscard]] std::optional<LostTexture> lost_texture(const optics::Surface& surface,
                                                      std::span<const TextureLook> texture,
                                                      std::span<const double> seen);

}  // namespace voxtone::slicer
