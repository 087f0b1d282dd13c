// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture as a print: a flat slab, width x (width * height_px / width_px) x thickness, with the picture on its top,
// seen from above with the picture's upper edge at +y. Pixels are square unless the file gives two resolutions. One
// that has alpha is cut to shape along its outline (picture_outline.h), upright: width and height are those of what is
// left.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/models/mesh.h"
#include "io/pictures/picture.h"
#include "slicer/options/resolved_job.h"

namespace voxtone::slicer {

struct PictureSlab {
    /// The closed body; its first triangles are the top and carry the picture, all others are plain.
    io::ModelFile model;
    std::vector<std::string> notes;
    static constexpr std::uint32_t face_material = 0;
};

/// Whether the options say how large a picture is.
[[nodiscard]] bool is_sized(const PictureOptions& options);

/// Throws UsageError where neither the options nor the picture tell a size.
[[nodiscard]] PictureSlab make_picture_slab(const io::Picture& picture, const PictureOptions& options);

}  // namespace voxtone::slicer
