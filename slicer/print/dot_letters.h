// SPDX-License-Identifier: GPL-3.0-or-later
//
// Capital letters and digits of 5 x 7 dots, large enough to be printed as boxes. What is neither is a box of its own.
#pragma once

#include <array>
#include <cstdint>

namespace voxtone::slicer {

inline constexpr int letter_columns = 5, letter_rows = 7;

/// Rows from the top, in each the leftmost dot in bit 4. Small letters are taken as capitals.
[[nodiscard]] std::array<std::uint8_t, letter_rows> dot_letter(char letter);

}  // namespace voxtone::slicer
