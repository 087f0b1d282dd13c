// SPDX-License-Identifier: GPL-3.0-or-later
//
// STL, binary and text. Text is known by the words `solid` and `facet`, in any case, behind blanks or a byte order
// mark; a file that is as long as a binary one of its number of triangles is binary, whatever its header says. Colours
// have no standard there: attribute words that look like those of VisCAM (bit 15 set wherever a word is not zero, more
// than one word) or Magics ("COLOR=" in the header) are lost, which is said; words that are all the same, such as
// 0x2020 (blanks), are none.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_stl(ParseContext& context);

}  // namespace voxtone::io
