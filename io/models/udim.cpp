// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/udim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>

#include <fmt/format.h>

#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

constexpr int columns = 10, rows = 100, first_number = 1001;

std::string number_of_tile(UvTile tile) { return fmt::format("{}", first_number + tile.column + columns * tile.row); }
std::string place_of_tile(UvTile tile) { return fmt::format("u{}_v{}", tile.column + 1, tile.row + 1); }

bool is_tile(UvTile tile) { return tile.column >= 0 && tile.column < columns && tile.row >= 0 && tile.row < rows; }

/// The last run of exactly four digits that is the number of a tile.
std::optional<WrittenTile> written_number(const std::string& file) {
    static const std::regex number("(^|[^0-9])([0-9]{4})(?=[^0-9]|$)");
    std::optional<WrittenTile> last;
    for (std::sregex_iterator i(file.begin(), file.end(), number), end; i != end; ++i) {
        const int from_0 = std::stoi((*i)[2]) - first_number;
        const UvTile tile{from_0 % columns, from_0 / columns};
        if (from_0 < 0 || !is_tile(tile)) continue;
        const auto at = static_cast<std::size_t>(i->position(2));
        last = WrittenTile{file.substr(0, at) + "<UDIM>" + file.substr(at + 4), tile};
    }
    return last;
}

std::optional<WrittenTile> written_place(const std::string& file) {
    static const std::regex place("[uU]([0-9]{1,2})_[vV]([0-9]{1,3})(?=[^0-9]|$)");
    std::optional<WrittenTile> last;
    for (std::sregex_iterator i(file.begin(), file.end(), place), end; i != end; ++i) {
        const UvTile tile{std::stoi((*i)[1]) - 1, std::stoi((*i)[2]) - 1};
        if (!is_tile(tile)) continue;
        const auto at = static_cast<std::size_t>(i->position(0));
        last = WrittenTile{file.substr(0, at) + "<UVTILE>" + file.substr(at + static_cast<std::size_t>(i->length(0))),
                           tile};
    }
    return last;
}

}  // namespace

std::optional<std::string> tile_file(std::string_view marked, UvTile tile) {
    static constexpr std::array<std::pair<std::string_view, bool>, 8> marks{{{"<udim>", true},
                                                                             {"%3cudim%3e", true},
                                                                             {"$udim", true},
                                                                             {"%(udim)d", true},
                                                                             {"<uvtile>", false},
                                                                             {"%3cuvtile%3e", false},
                                                                             {"<tile>", false},
                                                                             {"u<u>_v<v>", false}}};
    const std::string lower = lower_case(marked);
    for (const auto& [mark, by_number] : marks) {
        const std::size_t at = lower.find(mark);
        if (at == std::string::npos) continue;
        return fmt::format("{}{}{}", marked.substr(0, at), by_number ? number_of_tile(tile) : place_of_tile(tile),
                           marked.substr(at + mark.size()));
    }
    return std::nullopt;
}

std::optional<WrittenTile> written_tile(std::string_view file) {
    constexpr std::size_t longest = 4096;  // of a path
    if (file.size() > longest) return std::nullopt;
    const std::string name(file);
    const auto by_number = written_number(name);
    return by_number ? by_number : written_place(name);
}

std::optional<UvTile> tile_of(std::span<const Eigen::Vector2f> uv) {
    constexpr float slack = 1e-3f;
    if (uv.empty()) return std::nullopt;
    Eigen::Vector2f least = uv.front(), most = uv.front();
    for (const Eigen::Vector2f& place : uv) {
        if (!place.allFinite()) return std::nullopt;
        least = least.cwiseMin(place);
        most = most.cwiseMax(place);
    }
    const Eigen::Vector2f middle = (least + most) / 2;
    if (!(middle.minCoeff() >= 0 && middle.maxCoeff() < rows)) return std::nullopt;
    const UvTile tile{static_cast<int>(std::floor(middle.x())), static_cast<int>(std::floor(middle.y()))};
    const Eigen::Vector2f low(static_cast<float>(tile.column), static_cast<float>(tile.row));
    const bool inside = (least - low).minCoeff() >= -slack && (most - low).maxCoeff() <= 1 + slack;
    if (!inside || !is_tile(tile)) return std::nullopt;
    return tile;
}

}  // namespace voxtone::io
