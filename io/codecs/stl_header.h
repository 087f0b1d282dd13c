// SPDX-License-Identifier: GPL-3.0-or-later
//
// What can be told about an STL file before it is parsed: whether the declared size can be true, and whether its
// attribute words look like colour, which STL has no standard for and which is not carried.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

/// Throws InputError when a binary file is shorter than it declares. Appends a sentence when the attribute words look
/// like colours of VisCAM (bit 15 set wherever a word is not zero, more than one word) or Magics ("COLOR=" in the
/// header). Words that are all the same, such as 0x2020 (blanks), are no colour.
void check_stl(std::span<const std::byte> bytes, const std::string& name, std::vector<std::string>& lost_colours);

}  // namespace voxtone::io
