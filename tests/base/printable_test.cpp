// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/printable.h"

#include <catch2/catch.hpp>

using namespace voxtone;

TEST_CASE("Good UTF-8 stays, every stray byte becomes U+FFFD") {
    const std::string good =
        "Gr\xC3\xBC\xC3\x9F"
        "e \xE2\x82\xAC \xF0\x9F\x90\xAE";
    CHECK(valid_utf8(good) == good);
    const std::string mark = "\xEF\xBF\xBD";
    CHECK(valid_utf8("a\xFF"
                     "b") == "a" + mark + "b");
    CHECK(valid_utf8("\xC3") == mark);                                   // cut short
    CHECK(valid_utf8("\xE2\x82") == mark + mark);                        // cut short
    CHECK(valid_utf8("\xC0\xAF") == mark + mark);                        // overlong '/'
    CHECK(valid_utf8("\xE0\x80\xAF") == mark + mark + mark);             // overlong '/'
    CHECK(valid_utf8("\xED\xA0\x80") == mark + mark + mark);             // a surrogate
    CHECK(valid_utf8("\xF4\x90\x80\x80") == mark + mark + mark + mark);  // above U+10FFFF
}

TEST_CASE("No text can move the cursor") {
    CHECK(printable("a\x1b[2Jb\x7f\r") == "a?[2Jb??");
    CHECK(printable("\xC2\x9B"
                    "2J") == "?2J");  // the one-character form of ESC [
    CHECK(printable("two\nlines\tand \xC3\xA4") == "two\nlines\tand \xC3\xA4");
    CHECK(printable(std::string_view("a\0b", 3)) == "a?b");
}

TEST_CASE("JSON strings are escaped") {
    CHECK(json_quoted("a\"b\\c\n\t\x01") == R"("a\"b\\c\n\t\u0001")");
    CHECK(json_quoted("\xC3\xA4\xFF") == "\"\xC3\xA4\xEE\xBF\xBF\"");
    CHECK(json_quoted("") == "\"\"");
}

TEST_CASE("Any bytes go through valid UTF-8 and come back") {
    CHECK(escaped_bytes("plain \xC3\xA4 \xF0\x9F\x90\xAE") == "plain \xC3\xA4 \xF0\x9F\x90\xAE");
    CHECK(escaped_bytes("caf\xE9") == "caf\xEE\xBF\xA9");  // U+EFE9
    std::string all;
    for (int first = 1; first < 256; ++first)
        for (const char* rest : {"", "\x80", "\xBF\xBF", "\xBE\x80", "\xBF\xBF\xBF", "a", "\xEE\xBE"})
            for (const std::string& bytes : {std::string(1, char(first)) + rest, rest + std::string(1, char(first))}) {
                const std::string text = escaped_bytes(bytes);
                CHECK(valid_utf8(text) == text);
                CHECK(unescaped_bytes(text) == bytes);
                all += bytes;
            }
    CHECK(unescaped_bytes(escaped_bytes(all)) == all);
    // No two names become one: what looks like an escaped byte is escaped itself.
    CHECK(escaped_bytes("\xEE\xBF\xA9") != escaped_bytes("\xE9"));
}
