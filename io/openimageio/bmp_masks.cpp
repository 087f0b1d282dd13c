// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/bmp_masks.h"

#include <array>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

std::uint32_t number(std::span<const std::byte> file, std::size_t at, std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes && at + i < file.size(); ++i)
        value |= std::to_integer<std::uint32_t>(file[at + i]) << (8 * i);
    return value;
}

constexpr std::size_t info_bytes_at = 14, bits_at = 28, coding_at = 30, masks_at = 54;
constexpr std::uint32_t by_masks = 3;

/// Which byte a mask takes.
std::optional<std::size_t> byte_of(std::uint32_t mask) {
    for (std::size_t i = 0; i < 4; ++i)
        if (mask == std::uint32_t{0xff} << (8 * i)) return i;
    return {};
}

}  // namespace

void apply_bmp_masks(std::span<std::uint8_t> rgba, std::span<const std::byte> file, const std::string& name) {
    bool is_filling = true;
    for (std::size_t i = 3; i < rgba.size(); i += 4) is_filling = is_filling && rgba[i] == 0;
    if (is_filling && number(file, coding_at, 4) != by_masks)
        for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 255;
    constexpr std::uint32_t info_bytes_with_alpha = 56;
    constexpr std::array<std::uint32_t, 3> usual{0xff0000, 0xff00, 0xff};
    if (number(file, bits_at, 2) != 32 || number(file, coding_at, 4) != by_masks) return;
    std::array<std::uint32_t, 4> masks{};
    const bool has_alpha = number(file, info_bytes_at, 4) >= info_bytes_with_alpha;
    for (std::size_t c = 0; c < (has_alpha ? 4 : 3); ++c) masks[c] = number(file, masks_at + 4 * c, 4);
    if (masks[0] == usual[0] && masks[1] == usual[1] && masks[2] == usual[2]) return;
    constexpr std::array<std::size_t, 4> taken_as{2, 1, 0, 3};  // where OpenImageIO puts the file's bytes
    std::array<std::size_t, 4> from{};
    for (std::size_t c = 0; c < 4; ++c) {
        const std::optional<std::size_t> byte = byte_of(masks[c]);
        if (!byte && (c < 3 || masks[c] != 0))
            throw InputError(
                fmt::format("the picture {} is a BMP whose colours are not 8 bits each (masks {:#x}, {:#x}, {:#x}, "
                            "{:#x}); save it as PNG",
                            name, masks[0], masks[1], masks[2], masks[3]));
        from[c] = taken_as[byte.value_or(0)];
    }
    for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
        const std::array<std::uint8_t, 4> pixel{rgba[i], rgba[i + 1], rgba[i + 2], rgba[i + 3]};
        for (std::size_t c = 0; c < 4; ++c) rgba[i + c] = pixel[from[c]];
        if (masks[3] == 0) rgba[i + 3] = 255;
    }
}

}  // namespace voxtone::io
