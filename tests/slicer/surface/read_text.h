// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reads a label off a picture, letter by letter: where each letter stands every letter of an alphabet is tried, blurred
// to the picture's pixels, and the one that goes best with what is there is taken (correlation, so that neither
// contrast nor lightness is known). Letters are of one width, so that one wrong letter moves no other.
#pragma once

#include <string>

#include "io/lettering/coverage.h"
#include "tests/slicer/surface/seen_marks.h"

namespace voxtone::test {

struct TextPlace {
    std::string font;
    double em_mm = 0;
    double left_mm = 0, top_mm = 0;  ///< of the ink, in the picture
};

/// `text` is between brackets, which keep the ink's box whatever is between them: "[A17]". What is read, with them.
/// `dark`: the ink is darker than its ground.
[[nodiscard]] std::string read_text(const GreyPicture& picture, double pixel_mm, const TextPlace& place,
                                    const std::string& text, const std::string& alphabet, bool dark);

}  // namespace voxtone::test
