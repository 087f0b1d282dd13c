// SPDX-License-Identifier: GPL-3.0-or-later
//
// Textures that are cut into tiles by the unit square of their coordinates (UDIM): tile (column, row) is the picture
// 1001 + column + 10 row, or u(column + 1)_v(row + 1), with column below 10.
//
// A file name says so by a mark: <UDIM>, $UDIM or %(UDIM)d for the number, <UVTILE>, <TILE> or u<U>_v<V> for the other;
// in any case, and with %3C for <. Or it names one of the tiles, which a name alone cannot tell from one picture.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace voxtone::io {

struct UvTile {
    int column = 0, row = 0;
    auto operator<=>(const UvTile&) const = default;
};

/// The file of a tile where the name has a mark; nothing where it has none.
[[nodiscard]] std::optional<std::string> tile_file(std::string_view marked, UvTile tile);

/// A name of one tile ("skin.1001.png", "skin_u1_v1.png"), as a name with a mark. The last that may be one is it.
struct WrittenTile {
    std::string marked;
    UvTile tile;
};
[[nodiscard]] std::optional<WrittenTile> written_tile(std::string_view file);

/// The tile in which all coordinates lie, as near as a thousandth; nothing where they lie in several, or where there is
/// none: columns from 0 to 9, rows from 0 to 99.
[[nodiscard]] std::optional<UvTile> tile_of(std::span<const Eigen::Vector2f> uv);

}  // namespace voxtone::io
