// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/pictures/picture.h"

#include <fmt/format.h>

#include "voxtone/io/files/file_reader.h"
#include "voxtone/io/pictures/packed_image.h"

namespace voxtone::io {

Picture read_picture(const std::filesystem::path& path, const ReadOptions& options) {
    validate(options);
    std::vector<std::string> warnings;
    DecodedImage image =
        unpack_image(read_guarded(*start_reader(ReadKind::picture, path, options), options.progress, warnings));
    image.warnings.insert(image.warnings.begin(), warnings.begin(), warnings.end());
    return finish_picture(std::move(image), path.filename().string());
}

Picture finish_picture(DecodedImage image, const std::string& name) {
    Picture picture;
    picture.width_px = image.texels.width_px;
    picture.height_px = image.texels.height_px;
    picture.dpi_x = image.dpi_x;
    picture.dpi_y = image.dpi_y;
    picture.warnings = std::move(image.warnings);
    if (image.has_alpha) {
        picture.warnings.push_back(fmt::format("{} has transparent pixels; they were laid over white.", name));
        compose_over(image.texels, Eigen::Vector3f::Ones());
    }
    picture.texture = std::make_shared<const Texture>(std::move(image.texels), Wrap::clamp, Wrap::clamp);
    return picture;
}

}  // namespace voxtone::io
