// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a texture's contrast a print keeps: fur, feathers, cloth, the detail of a photograph.
//
//   t, p   Oklab's lightness of target and print behind the eye's narrowest Gaussian (halftone/loop/eye_filter.h), in a
//          room's light (job_prediction.h), each less its mean by a Gaussian twice as wide: what is as fine as the eye
//          can still see, some 1 to 3 lines a millimetre from 300 mm
//   S      a mean by a Gaussian eight times as wide, 1.2 mm from there
//   c      = sqrt(S(t^2)), the contrast that is asked for; k = S(t p) / S(t^2), the part of it that the print has.
//          Grain, which the target knows nothing of, neither adds to it nor takes away
//
// It is lost where k < 1/2 and c (1 - k), what is missing, is 0.0075 or more, some 0.9 of L*. Where most of what lies
// within S is of flat regions (halftone/loop/colour_regions.h) nothing is a texture: edges between them, type and lines
// are judged by themselves. The figures were chosen on img_kodim23 of 20 mm, open loop and loop, seen as the eye sees
// them: the open loop's blur is lost over 42 % of it, of the loop's print 1 %. With a mean within 1.2 mm in the place
// of the narrow one coarse edges, which every print has, hide that feathers are gone: 0.66 and 0.84 of all contrast are
// kept then, and lost it is over 3 % and nowhere.
// What it cannot see: texture of hue alone; detail that the target's own cells have already averaged.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/colour_regions.h"
#include "optics/scene/surface.h"

namespace voxtone::slicer {

struct TextureLook {
    float asked = 0;  ///< c; 0 where it is no texture
    float kept = 1;   ///< k
    [[nodiscard]] bool is_lost() const { return kept < 0.5f && asked * (1 - kept) >= 0.0075f; }
};

/// Per cell. `near_target`, `near`: what the narrowest Gaussian leaves of target and print, linear sRGB with a room's
/// light over them; `regions`: of the target. Time for a million cells: that of two narrowest EyeFilters and eight of
/// their `smoothed`.
[[nodiscard]] std::vector<TextureLook> look_at_texture(const optics::Surface& surface,
                                                       std::span<const Eigen::Vector3f> near_target,
                                                       std::span<const Eigen::Vector3f> near,
                                                       std::span<const halftone::ColourRegion> regions,
                                                       double viewing_distance_mm);

struct LostTexture {
    std::vector<std::uint32_t> cells;  ///< ascending
    double area_mm2 = 0;
    double seen_share = 0;  ///< of all that is seen
    double kept = 0;        ///< of all their contrast, at least 0
};

/// Nothing where it is less than a fiftieth of what is seen. `seen`: per cell, its area by how far it can be seen.
[[nodiscard]] std::optional<LostTexture> lost_texture(const optics::Surface& surface,
                                                      std::span<const TextureLook> texture,
                                                      std::span<const double> seen);

}  // namespace voxtone::slicer
