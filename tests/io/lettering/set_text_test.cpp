// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text of one and of two directions: the order of its letters, by glyphs and by what is drawn.
#include "io/lettering/set_text.h"

#include <algorithm>
#include <string_view>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/lettering/font_file.h"
#include "io/lettering/glyph_line.h"
#include "io/lettering/text_runs.h"
#include "tests/io/lettering/ink_letters.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

const FontFace& usual() {
    static const FontFace font(find_font(default_font), 120);
    return font;
}

std::string letter_of(const std::string& text, std::size_t at) {
    std::size_t end = at + 1;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) ++end;
    return text.substr(at, end - at);
}

/// Marks of direction have no ink.
bool is_unseen(const std::string& letter) {
    constexpr std::string_view unseen[]{"\u200E", "\u200F", "\u202A", "\u202B", "\u202C", "\u202D",
                                        "\u202E", "\u2066", "\u2067", "\u2068", "\u2069", "\u061C"};
    return std::ranges::find(unseen, letter) != std::end(unseen);
}

/// Letters as their glyphs stand, from the left; of ligatures the first.
std::string seen(const std::string& text) {
    std::string letters;
    for (const LaidGlyph& laid : lay_glyphs(usual(), text).glyphs)
        if (const std::string letter = letter_of(text, laid.letter); !is_unseen(letter)) letters += letter;
    return letters;
}

std::vector<std::uint32_t> glyphs(const std::string& text) {
    std::vector<std::uint32_t> numbers;
    for (const LaidGlyph& laid : lay_glyphs(usual(), text).glyphs) numbers.push_back(laid.glyph);
    return numbers;
}

/// Whether the glyphs of `part` stand side by side in those of `text`.
bool holds_glyphs(const std::string& text, const std::string& part) {
    const auto all = glyphs(text), some = glyphs(part);
    return std::search(all.begin(), all.end(), some.begin(), some.end()) != all.end();
}

}  // namespace

TEST_CASE("Numbers and Latin stand from left to right among letters that run from right to left") {
    CHECK(seen("A-17") == "A-17");
    CHECK(seen("שלום") == "םולש");
    CHECK(seen("שלום 17") == "17 םולש");
    CHECK(seen("17 שלום") == "םולש 17");
    CHECK(seen("A-17 שלום") == "A-17 םולש");
    CHECK(seen("שלום A-17") == "A-17 םולש");
    CHECK(seen("א 1.5 ב 2,75") == "2,75 ב 1.5 א");
    CHECK(seen("12:30 א") == "א 12:30");
    CHECK(seen("-5 א") == "א 5-");  // as UAX 9 has it: a sign before a number is neutral
    CHECK(seen("LOT שלום 2026-11") == "LOT 2026-11 םולש");
}

TEST_CASE("Brackets are mirrored where they run from right to left, and enclose what they enclosed") {
    CHECK(seen("שלום (A1)") == ")A1( םולש");  // of each the letter that was written
    const auto laid = glyphs("שלום (A1)");
    CHECK(laid.front() == glyphs("(").front());
    CHECK(laid[3] == glyphs(")").front());
    CHECK(seen("(שלום)") == ")םולש(");
    CHECK(glyphs("(שלום)").front() == glyphs("(").front());
    CHECK(seen("A (שלום) 1") == "A (םולש) 1");
    CHECK(seen("(A1)") == "(A1)");
}

TEST_CASE("Arabic letters are joined wherever they stand") {
    CHECK(seen("سلام") == "ملس");  // lam and alef are one glyph
    CHECK(seen("سلام 12") == "12 ملس");
    CHECK(seen("Latin سلام") == "Latin ملس");
    for (const char* text : {"سلام 12", "Latin سلام", "Latin سلام 12", "שלום سلام", "(سلام)"}) {
        CAPTURE(text);
        CHECK(holds_glyphs(text, "سلام"));
    }
    // Each of its letters alone looks otherwise.
    CHECK(glyphs("س") != std::vector{glyphs("سلام").back()});
    CHECK(seen("٣٤ سلام ١٢") == "١٢ ملس ٣٤");
}

TEST_CASE("Marks of direction decide, and are not seen") {
    CHECK(seen("\u202Eabc\u202C") == "cba");
    CHECK(seen("\u200Fa 1") == "a 1");
    CHECK(seen("\u200F1 a") == "a 1");
    CHECK(seen("א \u2066A-17 (ב)\u2069 ג") == "ג A-17 (ב) א");
    CHECK(seen("A \u200Eשלום\u200E 17") == "A םולש 17");
    CHECK(seen("A שלום 17") == "A 17 םולש");
    CHECK(lay_glyphs(usual(), "a\u200Eb").width_px == lay_glyphs(usual(), "ab").width_px);
}

TEST_CASE("Scripts are shaped each by its own rules, in one line") {
    CHECK(seen("A Ω Я א 5") == "A Ω Я 5 א");
    const std::string line = "A1 Ω2 Я";
    const std::vector<TextRun> runs = text_runs(line);
    REQUIRE(runs.size() == 3);
    CHECK(line.substr(runs[0].begin, runs[0].end - runs[0].begin) == "A1 ");
    CHECK(line.substr(runs[1].begin, runs[1].end - runs[1].begin) == "Ω2 ");
    CHECK(runs[0].script != runs[1].script);
    CHECK(text_runs("").empty());
    CHECK(text_runs("17").size() == 1);
    for (const TextRun& run : text_runs("17 (א)")) CHECK(run.end > run.begin);
}

TEST_CASE("What cannot be laid is refused, and said") {
    CHECK_THROWS_WITH(set_text("A-17 שלום 東", find_font(default_font), 2), Contains("has no '東'"));
    CHECK_THROWS_WITH(set_text("שלום \xE9", find_font(default_font), 2), Contains("no UTF-8"));
    CHECK_THROWS_WITH(set_text("\u200F\n ", find_font(default_font), 2), Contains("leaves no ink"));
    CHECK_THROWS_AS(set_text("a\tb\x01", find_font(default_font), 2), InputError);
}

TEST_CASE("What is drawn is read off the picture") {
    const auto font = find_font(default_font);
    constexpr double em_mm = 4;
    const std::vector<std::string> alphabet{"0", "1", "2", "5", "7", "A", "B", "-", "(", ")", "ש", "ל", "ו", "ם", "א"};
    const auto read = [&](const std::string& text) {
        return test::letters_in(set_text(text, font, em_mm), alphabet, font, em_mm);
    };
    CHECK(read("A-17") == "A-17");
    CHECK(read("שלום 17") == "17םולש");
    CHECK(read("A-17 שלום") == "A-17םולש");
    CHECK(read("שלום (A1)") == "(A1)םולש");
    CHECK(read("אB20751") == "B20751א");
    // A line is a paragraph of its own, and Windows' ends of lines are ends of lines.
    const Coverage one = set_text("A-17", font, em_mm), two = set_text("A-17\nשלום 17", font, em_mm),
                   windows = set_text("A-17\r\nשלום 17", font, em_mm);
    CHECK(two.ink == windows.ink);
    const Coverage second = set_text("שלום 17", font, em_mm);
    REQUIRE(two.width_px == std::max(one.width_px, second.width_px));
    Coverage below{two.width_px, second.height_px, two.pixel_mm, {}};
    below.ink.assign(two.ink.end() - std::ptrdiff_t(below.width_px) * below.height_px, two.ink.end());
    CHECK(test::letters_in(below, alphabet, font, em_mm) == "17םולש");
}
