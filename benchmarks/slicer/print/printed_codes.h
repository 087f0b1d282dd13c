// SPDX-License-Identifier: GPL-3.0-or-later
//
// QR and bar codes of several module sizes on one page, and which of them a decoder reads from a picture of it.
// Made and read by ZXing.
#pragma once

#include <string>
#include <vector>

#include "judge_slab.h"

namespace voxtone::loop_benchmark {

inline constexpr double codes_width_mm = 22, codes_height_mm = 16;

struct PrintedCode {
    bool square = false;  ///< QR; else Code 128
    std::string text;
    double module_mm = 0;
    double x = 0, y = 0, width = 0, height = 0;  ///< mm, y up
    std::vector<std::vector<char>> dark;         ///< rows of modules from the top; one row of a bar code
};

[[nodiscard]] std::vector<PrintedCode> printed_codes();

/// Smallest module, in mm, from which on all codes of its kind are read; 0: not even the largest.
struct ReadCodes {
    double square_mm = 0, bars_mm = 0;
};
/// `print`: cells of a page of codes, over its paper's level.
[[nodiscard]] ReadCodes read_codes(const Judgement& page, const Colours& print);

}  // namespace voxtone::loop_benchmark
