// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a mark's rectangle lies: where it is least seen, on the flattest face, on a side, at a point.
#pragma once

#include <optional>
#include <span>

#include "slicer/mesh/spatial_index.h"
#include "slicer/options/mark_options.h"
#include "slicer/surface/mark_frame.h"
#include "slicer/surface/mark_shape.h"

namespace voxtone::slicer {

/// Where marks may lie.
struct MarkedBody {
    const SolidIndex& solid;
    std::optional<Eigen::Vector3d> picture_faces{};  ///< of a picture's slab, where it looks
};

/// A label that is told no place on a side lies where that is flattest (flat_place.h), clear of those that are `taken`;
/// a picture in the middle of a side. Not for rectangles of the texture. Throws InputError where no face is as large as
/// that.
[[nodiscard]] MarkFrame place_of_mark(const MarkOptions& mark, const MarkShape& shape, const MarkedBody& body,
                                      std::span<const MarkFrame> taken);

/// Which share of that size, turned by so many degrees as labels are, has place at the bottom of a model; 0: none above
/// a twentieth has.
[[nodiscard]] double share_that_fits_below(const MarkedBody& body, double width_mm, double height_mm, double turn_deg,
                                           std::span<const MarkFrame> taken);

}  // namespace voxtone::slicer
