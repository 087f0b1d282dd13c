// SPDX-License-Identifier: GPL-3.0-or-later
//
// The file of a font, by name or path. Names go through fontconfig, which takes something like it where a name is not
// there; here that is an error: a label is set in the font that was asked for, or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace voxtone::io {

/// Of labels whose font is not said: bold, because thin strokes of a small label drown in the light around them.
inline constexpr const char* default_font = "DejaVu Sans:bold";

/// Whether the text is a file's path and no font's name.
[[nodiscard]] bool is_font_path(const std::string& name);

/// A path is given back as it is; a name ("DejaVu Sans", "DejaVu Sans:bold") is looked up. Throws InputError where this
/// machine has no such font.
[[nodiscard]] std::filesystem::path find_font(const std::string& name);

}  // namespace voxtone::io
