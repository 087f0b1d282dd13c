// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/make_code.h"

#include <algorithm>
#include <exception>

#define ZX_USE_UTF8 1
#include <ZXing/BitMatrix.h>
#include <ZXing/CharacterSet.h>
#include <ZXing/MultiFormatWriter.h>
#include <fmt/core.h>

#include "base/error.h"
#include "io/lettering/gs1_symbol.h"

namespace voxtone::io {

CodeSymbol make_code(CodeKind kind, const std::string& text) {
    if (kind != CodeKind::qr && kind != CodeKind::data_matrix) return make_gs1_code(kind, text);
    const bool is_qr = kind == CodeKind::qr;
    try {
        ZXing::MultiFormatWriter writer(is_qr ? ZXing::BarcodeFormat::QRCode : ZXing::BarcodeFormat::DataMatrix);
        writer.setMargin(0);
        // A note of the encoding takes room, which plain letters do without.
        const bool plain = std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
        if (is_qr && !plain) writer.setEncoding(ZXing::CharacterSet::UTF8);
        const ZXing::BitMatrix matrix = writer.encode(text, 0, 0);
        const int quiet = is_qr ? 4 : 1;
        CodeSymbol symbol{matrix.width(), matrix.height(), {}, quiet, quiet};
        for (int row = 0; row < symbol.rows; ++row)
            for (int column = 0; column < symbol.columns; ++column) symbol.dark.push_back(matrix.get(column, row));
        return symbol;
    } catch (const std::exception& fault) {
        throw InputError(fmt::format("\"{}\" does not go into a {} ({}): write less, or other letters", text,
                                     is_qr ? "QR code" : "Data Matrix", fault.what()));
    }
}

}  // namespace voxtone::io
