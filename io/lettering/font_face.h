// SPDX-License-Identifier: GPL-3.0-or-later
//
// A font's file in memory at a size, as FreeType draws it and HarfBuzz shapes text in it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct FT_LibraryRec_;
struct FT_FaceRec_;
struct hb_font_t;

namespace voxtone::io {

class FontFace {
public:
    /// Throws FileError; InputError for what is no font with outlines.
    FontFace(const std::filesystem::path& file, int pixels_an_em);

    [[nodiscard]] FT_FaceRec_* face() const { return face_.get(); }
    [[nodiscard]] hb_font_t* shaper() const { return shaper_.get(); }
    /// Of its file, for messages.
    [[nodiscard]] const std::string& name() const { return name_; }
    /// From the base of a line to that of the next.
    [[nodiscard]] double line_px() const;

private:
    struct Done {
        void operator()(FT_LibraryRec_* library) const;
        void operator()(FT_FaceRec_* face) const;
        void operator()(hb_font_t* font) const;
    };
    std::string name_;
    std::vector<std::byte> bytes_;
    std::unique_ptr<FT_LibraryRec_, Done> library_;
    std::unique_ptr<FT_FaceRec_, Done> face_;
    std::unique_ptr<hb_font_t, Done> shaper_;
};

}  // namespace voxtone::io
