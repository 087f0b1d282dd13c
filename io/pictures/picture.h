// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture as the input of a job: upright (EXIF orientation applied), in linear sRGB, alpha composed over white.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/files/read_options.h"
#include "io/pictures/decoded_image.h"
#include "io/pictures/texture.h"

namespace voxtone::io {

struct Picture {
    std::shared_ptr<const Texture> texture;  ///< not repeated at its borders
    std::uint32_t width_px = 0, height_px = 0;
    double dpi_x = 0, dpi_y = 0;  ///< 0 where the file has none
    double pixel_aspect = 1;      ///< height of a pixel by its width
    bool is_drawing = false;      ///< DecodedImage::is_drawing
    std::vector<std::string> warnings;
    std::string lost_colour;  ///< that of the warnings which tells of lost colours; empty: none is lost
    std::shared_ptr<const Texture> alpha_texture;  ///< where alpha is kept and the picture has some
    /// Of a picture that is to be cut to shape: rows from the top, 65535 is opaque; its texture has alpha nowhere. Else
    /// empty.
    std::vector<std::uint16_t> alpha;
};

/// What becomes of it.
enum class PictureAlpha : std::uint8_t { over_white, cut, kept };

/// Under the same walls as `read_model`. Throws FileError, InputError.
[[nodiscard]] Picture read_picture(const std::filesystem::path& path, const ReadOptions& options = {},
                                   PictureAlpha alpha = PictureAlpha::over_white);

/// The same as it is in the file, alpha and all.
[[nodiscard]] DecodedImage read_picture_with_alpha(const std::filesystem::path& path, const ReadOptions& options = {});

/// Pixels that have colours, of which none would be seen, become opaque, with a warning: the fourth byte of some
/// formats is no alpha. `name` is for the warning.
void show_if_invisible(DecodedImage& image, const std::string& name);

/// Of what looks_premultiplied.
[[nodiscard]] std::string premultiplied_warning(const std::string& name);

/// A decoded picture, composed over white. `name` is for the warning of that. `nearest`: Texture.
[[nodiscard]] Picture finish_picture(DecodedImage image, const std::string& name, bool nearest = false);

/// The same with its colours as they are, and alpha beside them.
[[nodiscard]] Picture finish_with_alpha(DecodedImage image, const std::string& name, bool nearest = false);

/// The same to be cut to shape where alpha is a half: colours are as in the file, without their alpha, and where alpha
/// is less those of what is nearest and opaque. Throws InputError where it is opaque everywhere, or nowhere.
[[nodiscard]] Picture finish_cut_out(DecodedImage image, const std::string& name, bool nearest = false);

}  // namespace voxtone::io
