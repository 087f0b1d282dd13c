// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/glyph_line.h"

#include <hb.h>

#include <memory>

#include <fmt/core.h>

#include "base/error.h"
#include "io/lettering/text_runs.h"

namespace voxtone::io {

namespace {

struct DestroyBuffer {
    void operator()(hb_buffer_t* buffer) const { hb_buffer_destroy(buffer); }
};

/// The letter that begins at this byte, as it was written.
std::string letter_at(const std::string& text, std::size_t at) {
    std::size_t end = at + 1;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) ++end;
    return text.substr(at, end - at);
}

/// Adds the run's glyphs at the end of the line.
void lay_run(const FontFace& font, const std::string& text, const TextRun& run, GlyphLine& line) {
    const std::unique_ptr<hb_buffer_t, DestroyBuffer> buffer(hb_buffer_create());
    hb_buffer_add_utf8(buffer.get(), text.data(), int(text.size()), unsigned(run.begin), int(run.end - run.begin));
    hb_buffer_set_direction(buffer.get(), run.right_to_left ? HB_DIRECTION_RTL : HB_DIRECTION_LTR);
    hb_buffer_set_script(buffer.get(), hb_script_t(run.script));
    hb_shape(font.shaper(), buffer.get(), nullptr, 0);
    constexpr double units_a_pixel = 64;
    unsigned count = 0;
    const hb_glyph_info_t* info = hb_buffer_get_glyph_infos(buffer.get(), &count);
    const hb_glyph_position_t* position = hb_buffer_get_glyph_positions(buffer.get(), &count);
    double up_px = 0;
    for (unsigned i = 0; i < count; ++i) {
        if (info[i].codepoint == 0)
            throw InputError(
                fmt::format("the font {} has no '{}', which stands in \"{}\": name a font that has it (font=...)",
                            font.name(), letter_at(text, info[i].cluster), text));
        line.glyphs.push_back({info[i].codepoint, info[i].cluster, line.width_px + position[i].x_offset / units_a_pixel,
                               up_px + position[i].y_offset / units_a_pixel});
        line.width_px += position[i].x_advance / units_a_pixel;
        up_px += position[i].y_advance / units_a_pixel;
    }
}

}  // namespace

GlyphLine lay_glyphs(const FontFace& font, const std::string& line) {
    GlyphLine laid;
    for (const TextRun& run : text_runs(line)) lay_run(font, line, run, laid);
    return laid;
}

}  // namespace voxtone::io
