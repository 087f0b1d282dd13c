// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/gs1_symbol.h"

#include <zint.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

struct Format {
    CodeKind kind;
    const char* name;
    int symbology;
    int quiet_columns, quiet_rows;
};
constexpr Format formats[]{{CodeKind::gs1_data_matrix, "GS1 DataMatrix", BARCODE_DATAMATRIX, 1, 1},
                           {CodeKind::gs1_qr, "GS1 QR Code", BARCODE_QRCODE, 4, 4},
                           {CodeKind::gs1_128, "GS1-128", BARCODE_GS1_128, 10, 0}};

/// Of bars, in their width: what ISO/IEC 15417 asks for at least.
constexpr double least_height = 0.15;

const Format& format_of(CodeKind kind) { return *std::ranges::find(formats, kind, &Format::kind); }

struct Delete {
    void operator()(zint_symbol* symbol) const { ZBarcode_Delete(symbol); }
};

/// "Error 261: AI (01) position 14: Bad checksum" without what only Zint knows.
std::string reason_in(const zint_symbol& symbol) {
    const std::string said = symbol.errtxt;
    const std::size_t colon = said.find(": ");
    return colon == std::string::npos ? said : said.substr(colon + 2);
}

[[noreturn]] void refuse(const Format& format, const std::string& text, const std::string& why) {
    throw InputError(
        fmt::format("\"{}\" does not go into a {} ({}): write each field behind its identifier in "
                    "brackets, such as (01)09501101530003(17)271231(10)AB-123(21)7",
                    text, format.name, why));
}

/// A row of bits as the symbol has it.
bool is_dark(const zint_symbol& symbol, int row, int column) {
    return (symbol.encoded_data[row][column / 8] >> (column % 8) & 1) != 0;
}

}  // namespace

CodeSymbol make_gs1_code(CodeKind kind, const std::string& text) {
    const Format& format = format_of(kind);
    const bool round = text.starts_with('('), square = text.starts_with('[');
    if (!round && !square) refuse(format, text, "it does not begin with an identifier");
    const std::unique_ptr<zint_symbol, Delete> made(ZBarcode_Create());
    if (!made) throw ResourceError("a code cannot be made: there is no memory");
    made->symbology = format.symbology;
    made->input_mode = GS1_MODE | (round ? GS1PARENS_MODE : 0);
    made->warn_level = WARN_FAIL_ALL;
    if (kind == CodeKind::gs1_data_matrix) made->option_3 = DM_SQUARE;
    const int fault =
        ZBarcode_Encode(made.get(), reinterpret_cast<const unsigned char*>(text.data()), int(text.size()));
    if (fault != 0) refuse(format, text, reason_in(*made));
    CodeSymbol symbol;
    symbol.is_bars = kind == CodeKind::gs1_128;
    symbol.columns = made->width;
    symbol.rows = symbol.is_bars ? int(std::ceil(least_height * made->width)) : made->rows;
    symbol.quiet_columns = format.quiet_columns;
    symbol.quiet_rows = format.quiet_rows;
    for (int row = 0; row < symbol.rows; ++row)
        for (int column = 0; column < symbol.columns; ++column)
            symbol.dark.push_back(is_dark(*made, symbol.is_bars ? 0 : row, column));
    return symbol;
}

}  // namespace voxtone::io
