// SPDX-License-Identifier: GPL-3.0-or-later
//
// All pixels of an opened picture, or none where some cannot be had.
//
// OpenImageIO 2.4 takes deflated TIFF strip by strip and does not look whether a strip is there and could be unpacked:
// of a file that was cut short it gives black. Row by row it goes through libtiff, which tells.
#pragma once

#include <cstddef>
#include <string_view>

namespace voxtone::io {

/// Whether samples are numbers of 64 bits, of which OpenImageIO 2.4 makes 0 (TIFF's rows and tiles).
template <class Spec>
[[nodiscard]] bool has_wide_numbers(const Spec& spec) {
    return spec.format.is_floating_point() && spec.format.size() > 4;
}

/// So many `channels` from `first` as `type`, rows from the top. False: the file is damaged; `input`, an ImageInput,
/// knows why.
template <class Input, class Type>
[[nodiscard]] bool read_rows(Input& input, int channels, Type type, void* pixels, int first = 0) {
    const auto& spec = input.spec();
    if (std::string_view(input.format_name()) != "tiff" || spec.tile_width > 0)
        return input.read_image(input.current_subimage(), 0, first, first + channels, type, pixels);
    const std::size_t row_bytes = std::size_t(spec.width) * std::size_t(channels) * type.size();
    for (int row = 0; row < spec.height; ++row) {
        const int y = spec.y + row;
        if (!input.read_scanlines(input.current_subimage(), 0, y, y + 1, spec.z, first, first + channels, type,
                                  static_cast<std::byte*>(pixels) + std::size_t(row) * row_bytes))
            return false;
    }
    return true;
}

}  // namespace voxtone::io
