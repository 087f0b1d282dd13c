// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/code_symbol.h"

#include <algorithm>
#include <exception>

#define ZX_USE_UTF8 1
#include <ZXing/BitMatrix.h>
#include <ZXing/CharacterSet.h>
#include <ZXing/MultiFormatWriter.h>
#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::io {

CodeSymbol make_code(CodeKind kind, const std::string& text) {
    const bool is_qr = kind == CodeKind::qr;
    try {
        ZXing::MultiFormatWriter writer(is_qr ? ZXing::BarcodeFormat::QRCode : ZXing::BarcodeFormat::DataMatrix);
        writer.setMargin(0);
        // A note of the encoding takes room, which plain letters do without.
        const bool plain = std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
        if (is_qr && !plain) writer.setEncoding(ZXing::CharacterSet::UTF8);
        const ZXing::BitMatrix matrix = writer.encode(text, 0, 0);
        CodeSymbol symbol{matrix.width(), matrix.height(), {}, is_qr ? 4 : 1};
        for (int row = 0; row < symbol.rows; ++row)
            for (int column = 0; column < symbol.columns; ++column) symbol.dark.push_back(matrix.get(column, row));
        return symbol;
    } catch (const std::exception& fault) {
        throw InputError(fmt::format("\"{}\" does not go into a {} ({}): write less, or other letters", text,
                                     is_qr ? "QR code" : "Data Matrix", fault.what()));
    }
}

}  // namespace voxtone::io
