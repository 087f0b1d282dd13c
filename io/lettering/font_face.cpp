// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/font_face.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include <hb-ft.h>
#include <hb.h>

#include <cstdint>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/read_bytes.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t most_font_bytes = std::uint64_t{256} << 20;

}  // namespace

void FontFace::Done::operator()(FT_LibraryRec_* library) const { FT_Done_FreeType(library); }
void FontFace::Done::operator()(FT_FaceRec_* face) const { FT_Done_Face(face); }
void FontFace::Done::operator()(hb_font_t* font) const { hb_font_destroy(font); }

FontFace::FontFace(const std::filesystem::path& file, int pixels_an_em)
    : name_(file.filename().string()), bytes_(read_bytes(file, most_font_bytes)) {
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

double FontFace::line_px() const { return double(face_->size->metrics.height) / 64; }

}  // namespace voxtone::io
