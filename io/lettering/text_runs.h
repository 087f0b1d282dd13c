// SPDX-License-Identifier: GPL-3.0-or-later
//
// A line of text as runs of one direction and one script, in the order in which they are seen: by the Unicode
// Bidirectional Algorithm (UAX 9), which FriBidi does. A line is a paragraph of its own: it runs as its first strong
// letter does, so that numbers and Latin stand from left to right among Hebrew or Arabic, wherever they stand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace voxtone::io {

struct TextRun {
    std::size_t begin = 0, end = 0;  ///< bytes of the line
    bool right_to_left = false;
    std::uint32_t script = 0;  ///< as HarfBuzz has it: four letters of ISO 15924
};

/// From the left. `line`: without line feeds. Throws InputError for what is no UTF-8.
[[nodiscard]] std::vector<TextRun> text_runs(const std::string& line);

}  // namespace voxtone::io
