// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels of four inks to sRGB codes: through the picture's own profile (relative colorimetric), else by the plain rule
// red = (1 - cyan) (1 - black), and so on, whose colours are rough, which is said.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

/// In place: cyan, magenta, yellow, black, the most is full ink; then RGBA, opaque. `profile` empty: none.
template <class Value>
void cmyk_to_srgb(std::span<Value> pixels, std::span<const std::uint8_t> profile, const std::string& name,
                  std::vector<std::string>& warnings);

extern template void cmyk_to_srgb(std::span<std::uint8_t>, std::span<const std::uint8_t>, const std::string&,
                                  std::vector<std::string>&);
extern template void cmyk_to_srgb(std::span<std::uint16_t>, std::span<const std::uint8_t>, const std::string&,
                                  std::vector<std::string>&);

}  // namespace voxtone::io
