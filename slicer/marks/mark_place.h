// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a mark's rectangle lies: on the flattest face, on a side, at a point.
#pragma once

#include <span>

#include "slicer/marks/mark_frame.h"
#include "slicer/mesh/spatial_index.h"
#include "slicer/options/mark_options.h"

namespace voxtone::slicer {

/// Where marks may lie.
struct MarkedBody {
    const SolidIndex& solid;
    bool top_only = false;  ///< a picture's slab, which has colour on its top alone
};

/// A label that is told no place on a side, and every mark on the flattest face, lies where the side is flattest
/// (flat_place.h), clear of those that are `taken`; a picture in the middle of a side. Not for rectangles of the
/// texture. Throws InputError where no face is as large as that.
[[nodiscard]] MarkFrame place_of_mark(const MarkOptions& mark, const MarkedBody& body, double width_mm,
                                      double height_mm, std::span<const MarkFrame> taken);

}  // namespace voxtone::slicer
