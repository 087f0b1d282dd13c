// SPDX-License-Identifier: GPL-3.0-or-later
//
// PNG, JPEG and TIFF files of chosen kinds, made on the spot by the formats' own libraries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace voxtone::test {

using Bytes = std::vector<std::byte>;

/// A chunk that is put in before the pixels.
struct PngChunk {
    std::string name, data;
};

struct PngKind {
    int colour_type = 2;  ///< as PNG numbers them
    int bits = 8;
    bool interlaced = false;
    bool keyed = false;  ///< one colour is transparent (tRNS); palettes get several alphas
    std::vector<PngChunk> chunks = {};
};

/// Noise that depends on the kind alone.
[[nodiscard]] Bytes png_of_kind(const PngKind& kind, std::uint32_t width, std::uint32_t height);
/// One colour, codes of 65535.
[[nodiscard]] Bytes png_of_colour(const Eigen::Vector3d& codes, const std::vector<PngChunk>& chunks);

struct JpegKind {
    int components = 3;  ///< 1 grey, 3 YCbCr, 4 CMYK as Adobe's programs store it, -4 CMYK without Adobe's mark
    bool progressive = false;
    int restart_rows = 0;
    int quality = 90;
    std::vector<std::uint8_t> app1 = {}, profile = {};
};

/// Slow waves of colour, so that every code says something.
[[nodiscard]] Bytes jpeg_of_kind(const JpegKind& kind, std::uint32_t width, std::uint32_t height);

struct TiffPage {
    int photometric = 2, bits = 8;  ///< 32 and 64: floating point, `pixel` is in 65535ths
    int tile = 0;                   ///< its side, a multiple of 16; 0: strips
    bool smaller_copy = false;
    std::vector<std::uint16_t> pixel;        ///< as stored; its length is the number of samples
    std::vector<std::uint8_t> profile = {};  ///< ICC
    float pixel_aspect = 0;                  ///< height by width, by resolutions without a unit; 0: not said
    bool is_signed = false;                  ///< SampleFormat says that all samples have a sign
    std::uint16_t extra = 0;                 ///< ExtraSamples of all channels beyond the colours
    std::vector<float> white = {};           ///< tag 318, x and y; empty: not said
    std::vector<std::uint16_t> second = {};  ///< every other pixel of a row of strips; empty: as the others
};

[[nodiscard]] Bytes tiff_of(const std::vector<TiffPage>& pages, std::uint32_t width = 20, std::uint32_t height = 10);

/// An ICC profile whose red is sRGB's blue and whose blue is sRGB's red; its curve is sRGB's.
[[nodiscard]] std::vector<std::uint8_t> swapped_profile();
/// Of phones' pictures.
[[nodiscard]] std::vector<std::uint8_t> display_p3_profile();

}  // namespace voxtone::test
