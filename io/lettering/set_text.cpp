// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/set_text.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include <hb-ft.h>
#include <hb.h>

#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/read_bytes.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t most_font_bytes = std::uint64_t{256} << 20;
constexpr int most_pixels_across = 60'000;

struct Done {
    void operator()(FT_Library library) const { FT_Done_FreeType(library); }
    void operator()(FT_Face face) const { FT_Done_Face(face); }
    void operator()(hb_font_t* font) const { hb_font_destroy(font); }
    void operator()(hb_buffer_t* buffer) const { hb_buffer_destroy(buffer); }
};
template <class Pointer>
using Held = std::unique_ptr<std::remove_pointer_t<Pointer>, Done>;

/// A font in memory at a size.
class Font {
public:
    Font(const std::filesystem::path& file, int pixels_an_em) : bytes_(read_bytes(file, most_font_bytes)) {
        FT_Library library = nullptr;
        if (FT_Init_FreeType(&library) != 0) throw ResourceError("FreeType cannot be started: there is no memory");
        library_.reset(library);
        FT_Face face = nullptr;
        const bool opened = FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(bytes_.data()),
                                               FT_Long(bytes_.size()), 0, &face) == 0;
        face_.reset(face);
        if (!opened || !FT_IS_SCALABLE(face) || FT_Set_Pixel_Sizes(face, 0, FT_UInt(pixels_an_em)) != 0)
            throw InputError(fmt::format(
                "{}: no font with outlines (TrueType, OpenType, Type 1); name another one (font=...)", file.string()));
        shaper_.reset(hb_ft_font_create_referenced(face));
        hb_ft_font_set_load_flags(shaper_.get(), FT_LOAD_NO_HINTING);
    }
    [[nodiscard]] FT_Face face() const { return face_.get(); }
    [[nodiscard]] hb_font_t* shaper() const { return shaper_.get(); }

private:
    std::vector<std::byte> bytes_;
    Held<FT_Library> library_;
    Held<FT_Face> face_;
    Held<hb_font_t*> shaper_;
};

/// A glyph's pixels and where they lie: x to the right, y down from the first line's base.
struct Drawn {
    int left, top, width, height;
    std::vector<std::uint8_t> ink;
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text) {
        if (c == '\n')
            lines.emplace_back();
        else
            lines.back() += c;
    }
    return lines;
}

/// The letter that begins at this byte, as it was written.
std::string letter_at(const std::string& text, std::size_t at) {
    std::size_t end = at + 1;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) ++end;
    return text.substr(at, end - at);
}

struct Line {
    Held<hb_buffer_t*> shaped;
    double width = 0;  ///< pixels
};

Line shape(const Font& font, const std::string& text, const std::filesystem::path& file) {
    Line line{Held<hb_buffer_t*>(hb_buffer_create()), 0};
    hb_buffer_add_utf8(line.shaped.get(), text.data(), int(text.size()), 0, int(text.size()));
    hb_buffer_guess_segment_properties(line.shaped.get());
    hb_shape(font.shaper(), line.shaped.get(), nullptr, 0);
    unsigned count = 0;
    const hb_glyph_info_t* info = hb_buffer_get_glyph_infos(line.shaped.get(), &count);
    const hb_glyph_position_t* position = hb_buffer_get_glyph_positions(line.shaped.get(), &count);
    for (unsigned i = 0; i < count; ++i) {
        if (info[i].codepoint == 0)
            throw InputError(
                fmt::format("the font {} has no '{}', which stands in \"{}\": name a font that has it "
                            "(font=...)",
                            file.filename().string(), letter_at(text, info[i].cluster), text));
        line.width += position[i].x_advance / 64.0;
    }
    return line;
}

void draw(const Font& font, const Line& line, double x, double y, std::vector<Drawn>& drawn) {
    unsigned count = 0;
    const hb_glyph_info_t* info = hb_buffer_get_glyph_infos(line.shaped.get(), &count);
    const hb_glyph_position_t* position = hb_buffer_get_glyph_positions(line.shaped.get(), &count);
    for (unsigned i = 0; i < count; ++i) {
        FT_Vector shift{FT_Pos(x * 64) + position[i].x_offset, FT_Pos(y * 64) + position[i].y_offset};
        FT_Set_Transform(font.face(), nullptr, &shift);
        if (FT_Load_Glyph(font.face(), info[i].codepoint, FT_LOAD_NO_HINTING | FT_LOAD_RENDER) == 0) {
            const FT_GlyphSlot slot = font.face()->glyph;
            Drawn glyph{slot->bitmap_left, -slot->bitmap_top, int(slot->bitmap.width), int(slot->bitmap.rows), {}};
            for (int row = 0; row < glyph.height; ++row)
                glyph.ink.insert(glyph.ink.end(), slot->bitmap.buffer + row * slot->bitmap.pitch,
                                 slot->bitmap.buffer + row * slot->bitmap.pitch + glyph.width);
            if (glyph.width > 0 && glyph.height > 0) drawn.push_back(std::move(glyph));
        }
        x += position[i].x_advance / 64.0;
        y += position[i].y_advance / 64.0;
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
    const Font font(font_file, pixels_an_em);
    std::vector<Line> lines;
    double widest = 0;
    for (const std::string& line : lines_of(text)) {
        lines.push_back(shape(font, line, font_file));
        widest = std::max(widest, lines.back().width);
    }
    if (widest > most_pixels_across)
        throw InputError(fmt::format("\"{}\" is {:.0f} times as long as its letters are high: it is no label", text,
                                     widest / pixels_an_em));
    const double line_px = double(font.face()->size->metrics.height) / 64;
    std::vector<Drawn> drawn;
    for (std::size_t l = 0; l < lines.size(); ++l)
        draw(font, lines[l], (widest - lines[l].width) / 2, -double(l) * line_px, drawn);
    if (drawn.empty()) throw InputError(fmt::format("\"{}\" leaves no ink: a label says something", text));
    return laid_together(drawn, em_mm / pixels_an_em);
}

}  // namespace voxtone::io
