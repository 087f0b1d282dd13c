// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/picture.h"

#include <fmt/format.h>

#include "base/warning.h"
#include "io/files/file_reader.h"
#include "io/pictures/packed_image.h"

namespace voxtone::io {

namespace {

bool is_invisible(const TexelImage& texels) {
    constexpr float least_seen_alpha = 1 / 255.0f;
    bool some_colour = false;
    for (std::size_t i = 0; i < texels.pixels(); ++i) {
        if (texels.alpha(i) >= least_seen_alpha) return false;
        some_colour = some_colour || texels.rgb(i).maxCoeff() > 0;
    }
    return some_colour;
}

}  // namespace

Picture read_picture(const std::filesystem::path& path, const ReadOptions& options) {
    return finish_picture(read_picture_with_alpha(path, options), path.filename().string(),
                          options.texture_filter == TextureFilter::nearest);
}

DecodedImage read_picture_with_alpha(const std::filesystem::path& path, const ReadOptions& options) {
    validate(options);
    std::vector<std::string> warnings;
    DecodedImage image;
    read_guarded(*start_reader(ReadKind::picture, path, options), options.progress, warnings,
                 [&](PackedReader& answer) { image = unpack_image(answer); });
    image.warnings.insert(image.warnings.begin(), warnings.begin(), warnings.end());
    return image;
}

void show_if_invisible(DecodedImage& image, const std::string& name) {
    if (!image.has_alpha || !is_invisible(image.texels)) return;
    image.warnings.push_back(named_warning(
        "transparent", fmt::format("All of {} is transparent, which cannot be meant; it was taken as opaque.", name)));
    for (std::size_t i = 0; i < image.texels.pixels(); ++i) image.texels.set_opaque(i);
    image.has_alpha = false;
}

Picture finish_picture(DecodedImage image, const std::string& name, bool nearest) {
    show_if_invisible(image, name);
    Picture picture;
    picture.width_px = image.texels.width_px;
    picture.height_px = image.texels.height_px;
    picture.dpi_x = image.dpi_x;
    picture.dpi_y = image.dpi_y;
    picture.pixel_aspect = image.pixel_aspect;
    picture.warnings = std::move(image.warnings);
    picture.lost_colour = std::move(image.lost_colour);
    if (!picture.lost_colour.empty()) picture.warnings.push_back(named_warning("lost-colour", picture.lost_colour));
    if (image.has_alpha) {
        picture.warnings.push_back(
            named_warning("transparent", fmt::format("{} has transparent pixels; they were laid over white.", name)));
        compose_over(image.texels, Eigen::Vector3f::Ones());
    }
    picture.texture = std::make_shared<const Texture>(std::move(image.texels), Wrap::clamp, Wrap::clamp, nearest);
    return picture;
}

}  // namespace voxtone::io
