// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/given_texture.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::io {

void lay_given_texture(ModelParts& parts, ParseContext& context, const std::filesystem::path& texture) {
    const std::string name = texture.filename().string();
    if (parts.corner_uv.empty())
        throw InputError(fmt::format(
            "{} has no texture coordinates, so that --texture {} cannot be laid on it; unwrap it in a mesh editor",
            context.name(), name));
    std::vector<bool> takes_it(parts.materials.size());
    for (const std::uint32_t m : parts.material_of_triangle)
        if (m < takes_it.size()) takes_it[m] = parts.materials[m].image < 0;
    if (std::find(takes_it.begin(), takes_it.end(), true) == takes_it.end())
        throw InputError(fmt::format(
            "{} has textures of its own, which --texture {} does not replace; leave it out, or change them in the file",
            context.name(), name));
    DecodedImage image =
        decode_image(read_bytes(texture, context.options().max_file_bytes), "'" + name + "'", context.decode_options());
    const auto index = static_cast<std::int32_t>(parts.images.size());
    for (std::string& warning : image.warnings) parts.warnings.push_back(std::move(warning));
    image.warnings.clear();
    if (!image.lost_colour.empty()) parts.lose_colour(image.lost_colour);
    parts.images.push_back(std::move(image));
    parts.image_names.push_back(name);
    for (std::size_t m = 0; m < takes_it.size(); ++m) {
        if (!takes_it[m]) continue;
        parts.materials[m].image = index;
        parts.materials[m].rgb.setOnes();
        parts.materials[m].alpha = 1;
    }
    for (std::size_t t = 0; t < std::min(parts.corner_rgba.size(), parts.material_of_triangle.size()); ++t)
        if (parts.material_of_triangle[t] < takes_it.size() && takes_it[parts.material_of_triangle[t]])
            parts.corner_rgba[t].fill(Eigen::Vector4f::Ones());
    parts.has_colour = true;
    parts.lost_textures.clear();
}

}  // namespace voxtone::io
