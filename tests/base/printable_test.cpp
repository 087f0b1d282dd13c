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

TEST_CASE("UTF-8 is well-formed up to the borders of Unicode's table and not beyond") {
    // Unicode 15, Table 3-7: the first and last sequences of each row, and their neighbours outside.
    for (const char* good :
         {"\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xE0\xBF\xBF", "\xE1\x80\x80", "\xEC\xBF\xBF",
          "\xED\x80\x80", "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF0\xBF\xBF\xBF",
          "\xF1\x80\x80\x80", "\xF3\xBF\xBF\xBF", "\xF4\x80\x80\x80", "\xF4\x8F\xBF\xBF"})
        CHECK(valid_utf8(good) == good);
    for (const char* bad :
         {"\x80", "\xBF", "\xC1\xBF", "\xC2\x7F", "\xDF\xC0", "\xE0\x9F\xBF", "\xE0\xA0\x7F", "\xE1\x80\xC0",
          "\xED\xA0\x80", "\xEF\xBF\xC0", "\xF0\x8F\xBF\xBF", "\xF1\x80\x80\x7F", "\xF1\x80\xC0\x80",
          "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF\x80\x80\x80", "\xF1\x80\x80", "\xE1\x80"}) {
        CAPTURE(int(static_cast<unsigned char>(bad[0])), std::string(bad).size());
        CHECK(valid_utf8(bad).starts_with("\xEF\xBF\xBD"));
    }
    CHECK(valid_utf8("") == "");
}

TEST_CASE("All control characters of both kinds are made harmless, and none besides") {
    for (int c = 1; c < 0x80; ++c) {
        const bool harmless = (c >= 0x20 && c != 0x7F) || c == '\n' || c == '\t';
        CHECK(printable(std::string(1, char(c))) == (harmless ? std::string(1, char(c)) : "?"));
    }
    for (int c = 0x80; c < 0xC0; ++c) {
        const std::string text{'\xC2', char(c)};
        CHECK(printable(text) == (c < 0xA0 ? "?" : text));
    }
    CHECK(printable("\xC3\x9B") == "\xC3\x9B");
}

TEST_CASE("Each byte that is no text has a character of its own") {
    for (int c = 0x80; c < 0x100; ++c) {
        const std::string bytes(1, char(c)), text = escaped_bytes(bytes);
        CHECK(text == std::string{'\xEE', char(c < 0xC0 ? 0xBE : 0xBF), char(0x80 | (c & 0x3F))});
        CHECK(unescaped_bytes(text) == bytes);
    }
    CHECK(unescaped_bytes("\xEE\xBD\xBF\xEE\x80\x80") == "\xEE\xBD\xBF\xEE\x80\x80");  // others of those planes
    CHECK(unescaped_bytes("\xEE\xBE") == "\xEE\xBE");                                  // cut short
    CHECK(json_quoted("\x1f \x7f") == "\"\\u001f \x7f\"");
}
