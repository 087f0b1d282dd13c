// SPDX-License-Identifier: GPL-3.0-or-later
//
// A line of text as glyphs of a font, from left to right: each run of one direction and script (text_runs.h) shaped by
// HarfBuzz with its neighbours in sight, so that Arabic letters are joined, marks placed and brackets mirrored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/lettering/font_face.h"

namespace voxtone::io {

struct LaidGlyph {
    std::uint32_t glyph;  ///< number in the font
    std::size_t letter;   ///< byte of the line at which the letters that it shows begin
    double x_px, y_px;    ///< of its origin: from the beginning of the line to the right, and up from its base
};

struct GlyphLine {
    std::vector<LaidGlyph> glyphs;
    double width_px = 0;
};

/// `line`: UTF-8 without line feeds. Throws InputError for what is no UTF-8 and for a letter that the font has not.
[[nodiscard]] GlyphLine lay_glyphs(const FontFace& font, const std::string& line);

}  // namespace voxtone::io
