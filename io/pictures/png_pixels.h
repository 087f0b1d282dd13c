// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reads any non-interlaced PNG row by row as 8-bit RGBA, with limits on what its header may claim; memory is a few
// rows. Pictures of numbers (8- or 16-bit grey) are read as they are.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

struct PngHeader {
    std::uint32_t width_px = 0, height_px = 0;
    int bit_depth = 0;    ///< per channel, as in the file
    int colour_type = 0;  ///< 0 grey, 2 RGB, 3 indexed, 4 grey + alpha, 6 RGBA
    bool interlaced = false;
    std::uint32_t x_per_metre = 0, y_per_metre = 0;  ///< 0 where the file does not say
    /// Names of chunks that say what its colours mean, in their order ("iCCP"): they are not applied.
    std::string colour_chunks{};
};

/// Colour type and depth in words: "8-bit RGBA (colour type 6)".
[[nodiscard]] std::string png_kind(const PngHeader& header);

/// The largest bitmap that is read, besides 65535 px a side; the tray of a J750 has 5.4e7.
inline constexpr std::uint64_t most_png_pixels = std::uint64_t{1} << 27;

/// The header alone. Throws InputError beginning with `source`.
[[nodiscard]] PngHeader read_png_header(std::span<const std::uint8_t> file, const std::string& source);

/// Calls `on_row(y, rgba)` for every row from the top; 4 bytes a pixel. Every checksum is checked and there is nothing
/// behind the end. Throws InputError beginning with `source`, perhaps after some rows.
PngHeader read_png(std::span<const std::uint8_t> file, const std::string& source,
                   const std::function<void(std::uint32_t y, std::span<const std::uint8_t> rgba)>& on_row);

struct GreyPicture {
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<std::uint16_t> samples;  ///< rows from the top
};

/// The numbers in a grey PNG of 8 or 16 bits. Throws InputError beginning with `source`, also for any other kind of
/// PNG.
[[nodiscard]] GreyPicture read_grey_png(std::span<const std::uint8_t> file, const std::string& source);

}  // namespace voxtone::io
