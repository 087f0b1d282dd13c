// SPDX-License-Identifier: GPL-3.0-or-later
//
// Codes of a text: QR (ISO/IEC 18004) and Data Matrix (ISO/IEC 16022), made by ZXing-C++; and those of GS1 (General
// Specifications, 2024), in which FNC1 stands first and between fields, made by Zint: GS1 DataMatrix, GS1 QR Code,
// GS1-128. Of these the fields are checked by GS1's table: identifiers, lengths, check digits, dates.
#pragma once

#include <string>

#include "io/lettering/code_symbol.h"

namespace voxtone::io {

/// `text`: UTF-8; a Data Matrix holds Latin 1. Of GS1: fields behind their identifiers in brackets,
/// "(01)09501101530003(21)SER1", or in square ones where brackets stand in a field. Throws InputError for a text that
/// does not go into one.
[[nodiscard]] CodeSymbol make_code(CodeKind kind, const std::string& text);

}  // namespace voxtone::io
