// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of text in a font, as ink: in the order in which they are read and shaped (glyph_line.h), drawn by FreeType
// from outlines without hinting, for a printer's dots are far finer than those that hints are made for. The picture is
// as large as the ink.
#pragma once

#include <filesystem>
#include <string>

#include "io/lettering/coverage.h"

namespace voxtone::io {

/// `text`: UTF-8; lines are parted by '\n' and stand under each other, centred. `em_mm`: size of the font, as in "6
/// pt". `pixels_an_em`: how finely it is drawn. Throws FileError; InputError for a file that is no font, a letter that
/// the font has not, and text without ink.
[[nodiscard]] Coverage set_text(const std::string& text, const std::filesystem::path& font, double em_mm,
                                int pixels_an_em = 120);

}  // namespace voxtone::io
