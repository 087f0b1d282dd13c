// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/image_rows.h"

#include <cstddef>
#include <string_view>

namespace voxtone::io {

bool read_rows(OIIO::ImageInput& input, int channels, OIIO::TypeDesc type, void* pixels) {
    const OIIO::ImageSpec& spec = input.spec();
    if (std::string_view(input.format_name()) != "tiff" || spec.tile_width > 0)
        return input.read_image(0, 0, 0, channels, type, pixels);
    const std::size_t row_bytes = std::size_t(spec.width) * std::size_t(channels) * type.size();
    for (int row = 0; row < spec.height; ++row) {
        const int y = spec.y + row;
        if (!input.read_scanlines(0, 0, y, y + 1, spec.z, 0, channels, type,
                                  static_cast<std::byte*>(pixels) + std::size_t(row) * row_bytes))
            return false;
    }
    return true;
}

}  // namespace voxtone::io
