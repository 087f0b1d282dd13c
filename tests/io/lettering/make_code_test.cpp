// SPDX-License-Identifier: GPL-3.0-or-later
//
// Codes, read back by ZXing: what is in them, and that those of GS1 say so.
#include "io/lettering/make_code.h"

#define ZX_USE_UTF8 1
#include <ZXing/ReadBarcode.h>
#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

ZXing::Result read_back(const CodeSymbol& code) {
    constexpr int px = 4;
    const int rows = code.rows + 2 * std::max(code.quiet_rows, 1);  // bars lie on a ground
    const int width = (code.columns + 2 * code.quiet_columns) * px, height = rows * px;
    std::vector<std::uint8_t> grey(std::size_t(width) * std::size_t(height), 255);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int column = x / px - code.quiet_columns, row = y / px - std::max(code.quiet_rows, 1);
            if (column >= 0 && row >= 0 && column < code.columns && row < code.rows &&
                code.dark[std::size_t(row * code.columns + column)])
                grey[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 0;
        }
    ZXing::DecodeHints hints;
    hints.setTryHarder(true);
    return ZXing::ReadBarcode({grey.data(), width, height, ZXing::ImageFormat::Lum}, hints);
}

/// What the code holds; as a text ZXing 2 writes a code of GS1 with its brackets.
std::string content(const ZXing::Result& read) { return {read.bytes().begin(), read.bytes().end()}; }

}  // namespace

TEST_CASE("Codes of GS1 begin with FNC1, and part their fields by it") {
    const std::string udi = "(01)09501101530003(17)271231(10)AB-123(21)7";
    const std::pair<CodeKind, std::string> kinds[]{
        {CodeKind::gs1_data_matrix, "]d2"}, {CodeKind::gs1_qr, "]Q3"}, {CodeKind::gs1_128, "]C1"}};
    for (const auto& [kind, identifier] : kinds) {
        CAPTURE(identifier);
        const CodeSymbol code = make_code(kind, udi);
        const ZXing::Result read = read_back(code);
        REQUIRE(read.isValid());
        CHECK(read.symbologyIdentifier() == identifier);
        CHECK(read.contentType() == ZXing::ContentType::GS1);
        CHECK(content(read) ==
              "01095011015300031727123110AB-123\x1D"
              "217");
        CHECK(code.dark.size() == std::size_t(code.columns * code.rows));
        CHECK(code.is_bars == (kind == CodeKind::gs1_128));
        // Square brackets, where a field has round ones.
        CHECK(content(read_back(make_code(kind, "[01]09501101530003[21]A(7)"))) == "010950110153000321A(7)");
    }
    CHECK(make_code(CodeKind::gs1_data_matrix, udi).columns == make_code(CodeKind::gs1_data_matrix, udi).rows);
}

TEST_CASE("Plain codes are as they were, and no GS1") {
    for (const CodeKind kind : {CodeKind::qr, CodeKind::data_matrix}) {
        const ZXing::Result read = read_back(make_code(kind, "(01)09501101530003"));
        REQUIRE(read.isValid());
        CHECK(read.contentType() != ZXing::ContentType::GS1);
        CHECK(content(read) == "(01)09501101530003");
    }
    CHECK_THROWS_WITH(make_code(CodeKind::data_matrix, std::string(4000, 'x')), Contains("Data Matrix"));
}

TEST_CASE("A code of GS1 with a fault is refused, with how one is written") {
    for (const CodeKind kind : {CodeKind::gs1_data_matrix, CodeKind::gs1_qr, CodeKind::gs1_128})
        for (const char* text : {"(01)09501101530004", "0109501101530003", "(01)0950110153000", "(04)123", "(17)271399",
                                 "A-17", "", "(01)", "(21)ä", "(10)123456789012345678901", "(01"}) {
            CAPTURE(text);
            CHECK_THROWS_AS(make_code(kind, text), InputError);
            CHECK_THROWS_WITH(make_code(kind, text), Contains("GS1") && Contains("(01)09501101530003"));
        }
}
