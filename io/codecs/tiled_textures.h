// SPDX-License-Identifier: GPL-3.0-or-later
//
// Textures that are cut into tiles (io/models/udim.h), laid on a model that has been read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "io/codecs/parse_context.h"
#include "io/models/model_parts.h"
#include "io/models/udim.h"

namespace voxtone::io {

/// Sentences for the user. `texture` as the file names it.
[[nodiscard]] std::string taken_for_tiles(const std::string& texture, const std::string& model);
[[nodiscard]] std::string beyond_tiles(std::size_t faces, const std::string& texture, const std::string& model);

/// Whether coordinates in these tiles leave the one that is named for neighbours that are there.
[[nodiscard]] bool has_neighbours(const WrittenTile& written, const std::set<UvTile>& used, ParseContext& context);

class TiledTextures {
public:
    /// A material's picture, as the file names it. With a mark in the name the material has none yet, and shows what
    /// is to be seen where there is no tile.
    void note(std::uint32_t material, const std::string& file) { file_of_[material] = file; }

    /// Gives each triangle the picture of its tile: by a mark in the name, or because coordinates leave the tile that
    /// is named for neighbours that are there. A triangle over several tiles says that the picture is repeated.
    void lay(ModelParts& parts, ParseContext& context) const;

private:
    std::map<std::uint32_t, std::string> file_of_;
};

}  // namespace voxtone::io
