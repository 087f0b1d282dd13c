// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures out: 8-bit sRGB PNG of pictures that are computed in linear light, and grey PNG of numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

/// Rows from the top. Linear sRGB and coverage in [0, 1]; colour is not multiplied by the coverage.
struct LinearPicture {
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<Eigen::Vector4f> pixels;
};

/// Rows from the top, 3 (RGB) or 4 (RGBA, alpha straight) bytes a pixel, sRGB codes.
struct Picture8 {
    std::uint32_t width_px = 0, height_px = 0;
    std::uint32_t channels = 3;
    std::vector<std::uint8_t> codes;
};

/// RGB: composed over an opaque background (linear sRGB), in linear light.
[[nodiscard]] Picture8 encode_over(const LinearPicture& picture, const Eigen::Vector3f& background);
/// RGBA; pixels without coverage are (0, 0, 0, 0).
[[nodiscard]] Picture8 encode_transparent(const LinearPicture& picture);

/// The bytes of a PNG file with an sRGB chunk; with its pixels' density (pHYs, as PNG has it: whole pixels per metre
/// along x and y) where px_per_mm is not 0, and with a comment (tEXt, Latin 1) where it is not empty. The same picture
/// gives the same bytes.
[[nodiscard]] std::vector<std::uint8_t> png_bytes(const Picture8& picture, std::array<double, 2> px_per_mm = {0, 0},
                                                  const std::string& comment = {});

/// The bytes of a grey PNG that holds these numbers, rows from the top: of 8 bits where all fit, else of 16.
[[nodiscard]] std::vector<std::uint8_t> number_png_bytes(std::uint32_t width_px, std::uint32_t height_px,
                                                         std::span<const std::uint16_t> numbers);
/// The same, of 16 bits whatever they are.
[[nodiscard]] std::vector<std::uint8_t> grey16_png_bytes(std::uint32_t width_px, std::uint32_t height_px,
                                                         std::span<const std::uint16_t> numbers);

}  // namespace voxtone::io
