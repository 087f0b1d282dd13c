// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture as a print: a flat slab, width x (width * height_px / width_px) x thickness, with the picture on its top,
// seen from above with the picture's upper edge at +y. Pixels are square unless the file gives two resolutions.
#pragma once

#include "io/models/mesh.h"
#include "io/pictures/picture.h"

namespace voxtone::slicer {

struct PictureSlab {
    /// The closed box; its first two triangles are the top and carry the picture, all others are plain.
    io::ModelFile model;
    static constexpr std::size_t top_triangles = 2;
};

/// `width_mm` 0: from the picture's own resolution. Throws UsageError where neither tells a width.
[[nodiscard]] PictureSlab make_picture_slab(const io::Picture& picture, double width_mm, double thickness_mm);

}  // namespace voxtone::slicer
