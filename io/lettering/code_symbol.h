// SPDX-License-Identifier: GPL-3.0-or-later
//
// QR codes (ISO/IEC 18004) and Data Matrix symbols (ISO/IEC 16022) of a text, made by ZXing-C++.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace voxtone::io {

enum class CodeKind : std::uint8_t { qr, data_matrix };

struct CodeSymbol {
    int columns = 0, rows = 0;
    std::vector<bool> dark;  ///< rows from the top
    int quiet_modules = 0;   ///< free on all sides, or readers do not find it: 4 of a QR code, 1 of a Data Matrix
};

/// `text`: UTF-8; a Data Matrix holds Latin 1. Throws InputError for a text that does not go into one.
[[nodiscard]] CodeSymbol make_code(CodeKind kind, const std::string& text);

}  // namespace voxtone::io
