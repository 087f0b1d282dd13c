// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/model_text.h"

#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone::io;
using namespace std::string_view_literals;

namespace {

std::string read(std::string_view bytes) { return model_text(std::as_bytes(std::span(bytes))); }

/// "aä€😀" and what else is asked for, in UTF-16 or 32.
std::string coded(const std::u32string& text, int bytes, bool big) {
    std::string out;
    const auto put = [&](std::uint32_t unit) {
        for (int b = 0; b < bytes; ++b) out += static_cast<char>(unit >> 8 * (big ? bytes - 1 - b : b));
    };
    for (const char32_t c : text) {
        if (bytes == 2 && c >= 0x10000) {
            put(0xd800 + ((std::uint32_t(c) - 0x10000) >> 10));
            put(0xdc00 + ((std::uint32_t(c) - 0x10000) & 0x3ff));
        } else {
            put(std::uint32_t(c));
        }
    }
    return out;
}

std::vector<std::pair<std::size_t, std::string>> lines_of(std::string_view text, bool joins = true) {
    TextLines lines(text, joins);
    std::vector<std::pair<std::size_t, std::string>> all;
    while (const auto line = lines.next()) all.emplace_back(lines.number(), std::string(*line));
    return all;
}

using Lines = std::vector<std::pair<std::size_t, std::string>>;

}  // namespace

TEST_CASE("A model's text is read in every form of Unicode that names itself", "[models]") {
    // One to four bytes each in UTF-8, and the last and first letters of each kind.
    const std::u32string text = U"v\u007f\u0080\u00e4\u07ff\u0800\u20ac\uffff\U00010000\U0001f600\U0010ffff";
    const std::string utf8 =
        "v\x7f\xc2\x80\xc3\xa4\xdf\xbf\xe0\xa0\x80\xe2\x82\xac\xef\xbf\xbf\xf0\x90\x80\x80\xf0\x9f\x98\x80"
        "\xf4\x8f\xbf\xbf";
    CHECK(read(utf8) == utf8);
    CHECK(read("\xef\xbb\xbf" + utf8) == utf8);
    for (const int bytes : {2, 4})
        for (const bool big : {false, true}) {
            CAPTURE(bytes, big);
            CHECK(read(coded(U"\ufeff" + text, bytes, big)) == utf8);
            CHECK(read(coded(U"\ufeff", bytes, big)).empty());
            // A cut unit is left out.
            CHECK(read(coded(U"\ufeff" + text, bytes, big) + "x") == utf8);
        }
}

TEST_CASE("What is no letter in UTF-16 or 32 becomes the replacement character", "[models]") {
    const std::string odd = "\xef\xbf\xbd";
    CHECK(read("\xff\xfe\x00\xd8"sv) == odd);                // half of a pair, at the end
    CHECK(read("\xff\xfe\x00\xd8\x41\x00"sv) == odd + "A");  // and before a letter
    CHECK(read("\xff\xfe\x00\xdc\x00\xd8"sv) == odd + odd);  // the wrong way round
    CHECK(read("\xff\xfe\x00\xd8\x00\xdc"sv) == "\xf0\x90\x80\x80");
    CHECK(read("\xff\xfe\x00\x00\x00\x00\x11\x00"sv) == odd);  // beyond the last plane
    CHECK(read("\xff\xfe\x00\x00\x00\xd8\x00\x00"sv) == odd);
    CHECK(read("\xff\xfe\x00\x00\xff\xdf\x00\x00"sv) == odd);
    CHECK(read("\xff\xfe\x00\x00\x00\xe0\x00\x00"sv) == "\xee\x80\x80");
}

TEST_CASE("UTF-16 without a mark is known by the zeros of its beginning, and binary data is not taken for it",
          "[models]") {
    for (const bool big : {false, true}) {
        CHECK(read(coded(U"v 1 2 3\n", 2, big)) == "v 1 2 3\n");
        CHECK(read(coded(U"v 1\u20ac 2", 2, big)) == "v 1\xe2\x82\xac 2");
    }
    const std::string short_text = coded(U"v 1", 2, false);
    CHECK(read(short_text) == short_text);  // too short to tell
    const std::string zeros(16, '\0');
    CHECK(read(zeros) == zeros);
    const std::string few = std::string("abcdefghijklmn\0p", 16);
    CHECK(read(few) == few);
}

TEST_CASE("Lines end as they do anywhere, and are counted alike", "[models]") {
    for (const std::string end : {"\n", "\r\n", "\r"})
        CHECK(lines_of("a" + end + " b \t" + end + end + "  " + end + "c") == Lines{{1, "a"}, {2, "b"}, {5, "c"}});
    CHECK(lines_of("").empty());
    CHECK(lines_of("\n \r\n").empty());
}

TEST_CASE("A backslash at a line's end takes the next line to it", "[models]") {
    CHECK(lines_of("f 1 \\\n 2 \\ \r\n 3\nv") == Lines{{1, "f 1 2 3"}, {4, "v"}});
    CHECK(lines_of("f 1 \\\n 2", false) == Lines{{1, "f 1 \\"}, {2, "2"}});
    CHECK(lines_of("# a \\\nb") == Lines{{1, "# a \\"}, {2, "b"}});  // of a comment it is a letter
    CHECK(lines_of("a \\") == Lines{{1, "a"}});
    CHECK(lines_of("\\\n\\\n b") == Lines{{1, "b"}});
    CHECK(lines_of("\\").empty());
    CHECK(lines_of("a \\\n\nb") == Lines{{1, "a"}, {3, "b"}});  // nothing is joined, and it ends
}

TEST_CASE("Words are cut off one by one, and numbers are whole words", "[models]") {
    std::string_view text = " \t one two\v three ";
    CHECK(cut_word(text) == "one");
    CHECK(text == "two\v three");
    CHECK(cut_word(text) == "two");
    CHECK(cut_word(text) == "three");
    CHECK(cut_word(text).empty());
    CHECK(trimmed("\f a b\r\n") == "a b");
    CHECK(trimmed(" \t").empty());
    CHECK(lower_case("AZaz@[`{09\xc4") == "azaz@[`{09\xc4");
    bool comma = false;
    CHECK(number_of("1.5", comma) == 1.5);
    CHECK(number_of("+1e3", comma) == 1000.0);
    CHECK(number_of("-2", comma) == -2.0);
    CHECK(std::isinf(number_of("inf", comma).value_or(0)));
    CHECK(std::isnan(number_of("nan", comma).value_or(0)));
    for (const char* none : {"", "+", "1.5x", "x", "1 2", "1.2.3", "1,2,3", "1,2.3", "++1"}) {
        CAPTURE(none);
        CHECK_FALSE(number_of(none, comma));
    }
    CHECK_FALSE(comma);
    CHECK(number_of("1,25", comma) == 1.25);
    CHECK(comma);
    CHECK(number_of("3", comma) == 3.0);
    CHECK(comma);  // and stays so
    bool none = false;
    CHECK(number_of("1," + std::string(38, '0'), none) == 1.0);
    CHECK_FALSE(number_of("1," + std::string(39, '0'), none));
}
