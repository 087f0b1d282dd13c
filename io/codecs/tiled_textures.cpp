// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/tiled_textures.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/printable.h"
#include "base/warning.h"

namespace voxtone::io {

namespace {

/// A triangle and the tile that it lies in.
struct TiledTriangle {
    std::size_t t = 0;
    std::optional<UvTile> tile;
};

/// The texture's name with a mark, if these triangles are to be laid with tiles.
std::optional<std::string> marked_name(const std::string& file, const std::vector<TiledTriangle>& triangles,
                                       ParseContext& context) {
    if (tile_file(file, {})) return file;
    const auto written = written_tile(file);
    std::set<UvTile> used;
    for (const TiledTriangle& triangle : triangles) {
        if (!triangle.tile) return std::nullopt;
        used.insert(*triangle.tile);
    }
    if (!written || !has_neighbours(*written, used, context)) return std::nullopt;
    return written->marked;
}

}  // namespace

std::string taken_for_tiles(const std::string& texture, const std::string& model) {
    return named_warning("which-colour",
                         fmt::format("The texture '{}' of {} was taken for one of several tiles (UDIM): coordinates "
                                     "lie beyond it, and its neighbours are there.",
                                     printable(texture), model));
}

std::string beyond_tiles(std::size_t faces, const std::string& texture, const std::string& model) {
    return fmt::format(
        "{} faces of {} lie over several tiles of the texture '{}' or in none: its colours are LOST there and the "
        "material's own colour is used. Cut the coordinates where tiles end.",
        faces, model, printable(texture));
}

bool has_neighbours(const WrittenTile& written, const std::set<UvTile>& used, ParseContext& context) {
    if (written.tile != UvTile{} && !used.contains(written.tile)) return false;
    return std::ranges::any_of(used, [&](const UvTile& tile) {
        return tile != written.tile && context.finds(*tile_file(written.marked, tile));
    });
}

void TiledTextures::lay(ModelParts& parts, ParseContext& context) const {
    std::map<std::uint32_t, std::vector<TiledTriangle>> triangles_of;
    for (std::size_t t = 0; t < parts.corner_uv.size(); ++t)
        if (const std::uint32_t material = parts.material_of_triangle[t]; file_of_.contains(material))
            triangles_of[material].push_back({t, tile_of(parts.corner_uv[t])});
    for (const auto& [material, triangles] : triangles_of) {
        const std::string& file = file_of_.at(material);
        const auto marked = marked_name(file, triangles, context);
        if (!marked) continue;
        if (*marked != file) parts.warnings.push_back(taken_for_tiles(file, context.name()));
        std::map<UvTile, std::uint32_t> made;
        std::size_t beyond = 0;
        for (const auto& [t, tile] : triangles) {
            beyond += !tile;
            if (!tile) continue;
            const auto [known, added] = made.try_emplace(*tile, static_cast<std::uint32_t>(parts.materials.size()));
            if (added) {
                PartMaterial of_tile = parts.materials[material];
                of_tile.image = context.add_image_file(parts, *tile_file(*marked, *tile), context.decode_options());
                if (of_tile.image >= 0) of_tile.rgb.setOnes();
                of_tile.wrap_u = of_tile.wrap_v = Wrap::clamp;
                parts.materials.push_back(std::move(of_tile));
            }
            parts.material_of_triangle[t] = known->second;
            for (Eigen::Vector2f& uv : parts.corner_uv[t])
                uv -= Eigen::Vector2f(static_cast<float>(tile->column), static_cast<float>(tile->row));
        }
        if (beyond > 0) parts.lose_colour(beyond_tiles(beyond, *marked, context.name()));
    }
}

}  // namespace voxtone::io
