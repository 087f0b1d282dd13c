// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/set_text.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/lettering/font_face.h"
#include "io/lettering/glyph_line.h"

namespace voxtone::io {

namespace {

constexpr int most_pixels_across = 60'000;

/// A glyph's pixels and where they lie: x to the right, y down from the first line's base.
struct Drawn {
    int left, top, width, height;
    std::vector<std::uint8_t> ink;
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text) {
        if (c != '\n') {
            lines.back() += c;
            continue;
        }
        if (lines.back().ends_with('\r')) lines.back().pop_back();  // as Windows ends lines
        lines.emplace_back();
    }
    return lines;
}

void draw(const FontFace& font, const GlyphLine& line, double x, double y, std::vector<Drawn>& drawn) {
    constexpr double units_a_pixel = 64;
    for (const LaidGlyph& laid : line.glyphs) {
        FT_Vector shift{FT_Pos((x + laid.x_px) * units_a_pixel), FT_Pos((y + laid.y_px) * units_a_pixel)};
        FT_Set_Transform(font.face(), nullptr, &shift);
        if (FT_Load_Glyph(font.face(), laid.glyph, FT_LOAD_NO_HINTING | FT_LOAD_RENDER) != 0) continue;
        const FT_GlyphSlot slot = font.face()->glyph;
        Drawn glyph{slot->bitmap_left, -slot->bitmap_top, int(slot->bitmap.width), int(slot->bitmap.rows), {}};
        for (int row = 0; row < glyph.height; ++row)
            glyph.ink.insert(glyph.ink.end(), slot->bitmap.buffer + row * slot->bitmap.pitch,
                             slot->bitmap.buffer + row * slot->bitmap.pitch + glyph.width);
        if (glyph.width > 0 && glyph.height > 0) drawn.push_back(std::move(glyph));
    }
}

Coverage laid_together(const std::vector<Drawn>& drawn, double pixel_mm) {
    int left = drawn[0].left, top = drawn[0].top, right = left, bottom = top;
    for (const Drawn& glyph : drawn) {
        left = std::min(left, glyph.left);
        top = std::min(top, glyph.top);
        right = std::max(right, glyph.left + glyph.width);
        bottom = std::max(bottom, glyph.top + glyph.height);
    }
    Coverage all{right - left, bottom - top, pixel_mm, {}};
    all.ink.resize(std::size_t(all.width_px) * std::size_t(all.height_px));
    for (const Drawn& glyph : drawn)
        for (int y = 0; y < glyph.height; ++y)
            for (int x = 0; x < glyph.width; ++x) {
                std::uint8_t& ink = all.ink[std::size_t(glyph.top - top + y) * std::size_t(all.width_px) +
                                            std::size_t(glyph.left - left + x)];
                ink = std::max(ink, glyph.ink[std::size_t(y) * std::size_t(glyph.width) + std::size_t(x)]);
            }
    return all;
}

}  // namespace

Coverage set_text(const std::string& text, const std::filesystem::path& font_file, double em_mm, int pixels_an_em) {
    const FontFace font(font_file, pixels_an_em);
    std::vector<GlyphLine> lines;
    double widest = 0;
    for (const std::string& line : lines_of(text)) {
        lines.push_back(lay_glyphs(font, line));
        widest = std::max(widest, lines.back().width_px);
    }
    if (widest > most_pixels_across)
        throw InputError(fmt::format("\"{}\" is {:.0f} times as long as its letters are high: it is no label", text,
                                     widest / pixels_an_em));
    std::vector<Drawn> drawn;
    for (std::size_t l = 0; l < lines.size(); ++l)
        draw(font, lines[l], (widest - lines[l].width_px) / 2, -double(l) * font.line_px(), drawn);
    if (drawn.empty()) throw InputError(fmt::format("\"{}\" leaves no ink: a label says something", text));
    return laid_together(drawn, em_mm / pixels_an_em);
}

}  // namespace voxtone::io
