// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an SVG drawing shows elsewhere and does not here: pictures in files of their own, HTML, text in fonts that this
// machine has not, letters that no font of it has.
#pragma once

#include <string>
#include <string_view>

#include "io/pictures/decoded_image.h"

namespace voxtone::io {

/// To the picture's warnings, and its lost colour. Throws InputError for text where there is no font at all.
void add_svg_facts(std::string_view text, const std::string& name, DecodedImage& image);

}  // namespace voxtone::io
