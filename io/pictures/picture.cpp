// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/picture.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/files/file_reader.h"
#include "io/pictures/alpha_picture.h"
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

Picture read_picture(const std::filesystem::path& path, const ReadOptions& options, PictureAlpha alpha) {
    const auto finish = alpha == PictureAlpha::cut    ? finish_cut_out
                        : alpha == PictureAlpha::kept ? finish_with_alpha
                                                      : finish_picture;
    return finish(read_picture_with_alpha(path, options), path.filename().string(),
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

namespace {

/// All but its texture.
Picture picture_of(DecodedImage& image) {
    Picture picture;
    picture.width_px = image.texels.width_px;
    picture.height_px = image.texels.height_px;
    picture.dpi_x = image.dpi_x;
    picture.dpi_y = image.dpi_y;
    picture.pixel_aspect = image.pixel_aspect;
    picture.is_drawing = image.is_drawing;
    picture.warnings = std::move(image.warnings);
    picture.lost_colour = std::move(image.lost_colour);
    if (!picture.lost_colour.empty()) picture.warnings.push_back(named_warning("lost-colour", picture.lost_colour));
    return picture;
}

std::vector<std::uint16_t> alpha_of(const TexelImage& texels) {
    std::vector<std::uint16_t> alpha(texels.pixels());
    for (std::size_t i = 0; i < alpha.size(); ++i)
        alpha[i] = static_cast<std::uint16_t>(texels.alpha(i) * 65535.0f + 0.5f);
    return alpha;
}

constexpr std::uint16_t half_alpha = 32768;

/// What is less than half opaque takes the colour of the smallest square around it that has some.
void spread_colours(TexelImage& texels, const std::vector<std::uint16_t>& alpha) {
    const AlphaPicture smaller(texels);
    constexpr float least = 1e-3f;
    for (std::size_t i = 0; i < alpha.size(); ++i) {
        if (alpha[i] >= half_alpha) {
            texels.set_opaque(i);
            continue;
        }
        const float x = float(i % texels.width_px) + 0.5f, y = float(i / texels.width_px) + 0.5f;
        Eigen::Vector4f found = Eigen::Vector4f::Zero();
        for (float lod = 1; found[3] < least && lod < 32; ++lod) found = smaller.sample(x, y, lod);
        if (found[3] > 0) texels.set(i, (found.head<3>() / found[3]).cwiseMin(1));
    }
}

}  // namespace

std::string premultiplied_warning(const std::string& name) {
    return named_warning(
        "premultiplied",
        fmt::format("The colours of {} are nowhere brighter than their alpha and grow with it, as if "
                    "they had been multiplied by it, and print too dark where it is between then; save "
                    "it with straight alpha.",
                    name));
}

Picture finish_picture(DecodedImage image, const std::string& name, bool nearest) {
    show_if_invisible(image, name);
    Picture picture = picture_of(image);
    if (image.has_alpha) {
        if (looks_premultiplied(image.texels)) picture.warnings.push_back(premultiplied_warning(name));
        picture.warnings.push_back(
            named_warning("transparent", fmt::format("{} has transparent pixels; they were laid over white. --alpha "
                                                     "translucency prints them so that light goes through, --cut-out "
                                                     "leaves them out.",
                                                     name)));
        compose_over(image.texels, Eigen::Vector3f::Ones());
    }
    picture.texture = std::make_shared<const Texture>(std::move(image.texels), Wrap::clamp, Wrap::clamp, nearest);
    return picture;
}

Picture finish_with_alpha(DecodedImage image, const std::string& name, bool nearest) {
    if (image.has_alpha && looks_premultiplied(image.texels)) image.warnings.push_back(premultiplied_warning(name));
    Picture picture = picture_of(image);
    if (image.has_alpha)
        picture.alpha_texture =
            std::make_shared<const Texture>(take_alpha(image.texels), Wrap::clamp, Wrap::clamp, nearest);
    picture.texture = std::make_shared<const Texture>(std::move(image.texels), Wrap::clamp, Wrap::clamp, nearest);
    return picture;
}

Picture finish_cut_out(DecodedImage image, const std::string& name, bool nearest) {
    Picture picture = picture_of(image);
    picture.alpha = alpha_of(image.texels);
    const auto opaque = std::ranges::count_if(picture.alpha, [](std::uint16_t alpha) { return alpha >= half_alpha; });
    if (opaque == 0)
        throw InputError(
            fmt::format("{}: is transparent all over, so that nothing of it is left to print; leave "
                        "--cut-out out, or save it with what is to be printed opaque",
                        name));
    if (std::size_t(opaque) == picture.alpha.size())
        throw InputError(
            fmt::format("{}: has no transparent pixels that it could be cut along; leave --cut-out out, "
                        "or save it as a PNG or WebP whose background is transparent",
                        name));
    if (looks_premultiplied(image.texels)) picture.warnings.push_back(premultiplied_warning(name));
    spread_colours(image.texels, picture.alpha);
    picture.texture = std::make_shared<const Texture>(std::move(image.texels), Wrap::clamp, Wrap::clamp, nearest);
    return picture;
}

}  // namespace voxtone::io
