// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels in the colours of an embedded ICC profile (RGB or CMYK) to sRGB codes, relative colorimetric.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace voxtone::io {

/// In place, on RGBA (alpha is kept). Profiles that agree with sRGB within 2 of 255 codes change nothing. Returns a
/// sentence where the profile could not be used (broken, or not of RGB data), else an empty string.
[[nodiscard]] std::string convert_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<std::uint8_t> rgba);
[[nodiscard]] std::string convert_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<std::uint16_t> rgba);
/// Codes are 0 to 1.
[[nodiscard]] std::string convert_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<float> rgba);

/// In place, from cyan, magenta, yellow, black (the most is full ink) to RGB and a fourth value that is not touched.
/// Returns a sentence where the profile could not be used, and pixels stay as they were; else an empty string.
[[nodiscard]] std::string convert_cmyk_icc_to_srgb(std::span<const std::uint8_t> profile,
                                                   std::span<std::uint8_t> pixels);
[[nodiscard]] std::string convert_cmyk_icc_to_srgb(std::span<const std::uint8_t> profile,
                                                   std::span<std::uint16_t> pixels);

}  // namespace voxtone::io
