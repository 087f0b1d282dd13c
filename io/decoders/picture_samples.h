// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture as its file has it, and its way to texels: what the decoders of all kinds share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/decoders/decode_options.h"
#include "io/decoders/picture_colours.h"

namespace voxtone::io {

struct PictureSamples {
    std::uint32_t width_px = 0, height_px = 0;
    /// RGBA, rows from the top; one of the three is filled. Floats may leave [0, 1].
    std::vector<std::uint8_t> bytes{};
    std::vector<std::uint16_t> words{};
    std::vector<float> floats{};
    bool premultiplied = false;               ///< RGB was stored multiplied by alpha
    PictureColours colours{};                 ///< sRGB codes; linear light for floats
    std::vector<std::uint8_t> icc_profile{};  ///< of RGB data: goes before `colours`; empty: none
    double dpi_x = 0, dpi_y = 0;              ///< 0: not in the file
    double pixel_aspect = 1;                  ///< height by width, where there is no dpi
    int orientation = 1;                      ///< EXIF, 1 to 8; others count as 1
    std::vector<std::string> warnings{};
    std::string lost_colour{};  ///< DecodedImage::lost_colour

    [[nodiscard]] std::size_t pixels() const { return std::size_t{width_px} * height_px; }
};

/// Throws InputError where a picture declares a size of 0 or more pixels than are allowed; before memory is taken.
void check_picture_size(std::uint64_t width_px, std::uint64_t height_px, const std::string& name,
                        const DecodeOptions& options);

/// Takes the samples' memory. `name` is for messages.
[[nodiscard]] DecodedImage to_texels(PictureSamples samples, const std::string& name, const DecodeOptions& options);

/// Spreads 1 to 4 channels to RGBA in place of a buffer of 4 channels; of two, the second may be alpha.
template <class Value>
void spread_to_rgba(std::vector<Value>& pixels, std::size_t count, int channels, bool second_is_alpha, Value opaque) {
    if (channels == 4) return;
    for (std::size_t i = count; i-- > 0;) {  // from the back, so that nothing is overwritten before it is read
        Value in[3]{};
        std::copy_n(pixels.begin() + std::ptrdiff_t(i) * channels, channels, in);
        const bool grey = channels < 3;
        pixels[4 * i] = in[0];
        pixels[4 * i + 1] = grey ? in[0] : in[1];
        pixels[4 * i + 2] = grey ? in[0] : in[2];
        pixels[4 * i + 3] = channels == 2 && second_is_alpha ? in[1] : opaque;
    }
}

}  // namespace voxtone::io
