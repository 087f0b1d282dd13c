// SPDX-License-Identifier: GPL-3.0-or-later
//
// A decoded picture as bytes, on its way out of the process that decoded it (io/files/packed_values.h).
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "io/files/packed_values.h"
#include "io/pictures/decoded_image.h"

namespace voxtone::io {

template <class Stream, class Image>
requires std::is_same_v<std::remove_const_t<Image>, DecodedImage>
void describe(Stream& stream, Image& i) {
    stream(i.texels.width_px, i.texels.height_px, i.texels.srgb8, i.texels.linear16, i.dpi_x, i.dpi_y, i.pixel_aspect,
           i.has_alpha, i.is_drawing, i.warnings, i.lost_colour);
}

/// Throws InputError when the picture's size is not that of its texels: what comes from the reader is not believed.
void check_decoded(const DecodedImage& image);

[[nodiscard]] std::vector<std::byte> pack(const DecodedImage& image);
[[nodiscard]] Packing packing_of(DecodedImage image);
/// Throws InputError when the bytes are cut short, or are no picture.
[[nodiscard]] DecodedImage unpack_image(std::span<const std::byte> bytes);
[[nodiscard]] DecodedImage unpack_image(PackedReader& reader);

}  // namespace voxtone::io
