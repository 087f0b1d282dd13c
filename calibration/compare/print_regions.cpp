// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/profiles/resin_file.h"
#include "optics/colour/channels.h"

namespace voxtone::calibration {

namespace {

constexpr std::size_t most_tiles = 200;
constexpr double least_tile_mm = 0.7;
constexpr double least_share_of_tile = 0.3;
constexpr const char* sheet_format = "voxtone-print-regions";
constexpr double most_colour = 1e3, most_change = 1e6;

/// Means of a response over what lies in a tile.
Eigen::Matrix3Xd changes_over(const TileCells& tile, const ResinResponse& response, const Eigen::Matrix3Xd& weights,
                              const Eigen::Vector3d& predicted) {
    const auto values = Eigen::Index(2 * response.resins * response.channels);
    Eigen::Matrix3Xd by = Eigen::Matrix3Xd::Zero(3, values);
    Eigen::Vector3d base = Eigen::Vector3d::Zero();
    const int block = response.block;
    for (int row = tile.row / block; row <= (tile.row + tile.rows - 1) / block; ++row)
        for (int column = tile.column / block; column <= (tile.column + tile.columns - 1) / block; ++column) {
            const int w =
                std::min(tile.column + tile.columns, (column + 1) * block) - std::max(tile.column, column * block);
            const int h = std::min(tile.row + tile.rows, (row + 1) * block) - std::max(tile.row, row * block);
            const double area = double(w) * h;
            const std::size_t at = std::size_t(row) * std::size_t(response.columns) + std::size_t(column);
            for (std::size_t c = 0; c < response.channels; ++c) {
                const Eigen::Vector3d of_channel = area * weights.col(Eigen::Index(c));
                base += of_channel * double(response.value[at * response.channels + c]);
                for (std::size_t r = 0; r < response.resins; ++r) {
                    const std::size_t from = (at * response.resins + r) * response.channels + c;
                    const auto to = Eigen::Index(2 * (r * response.channels + c));
                    by.col(to) += of_channel * double(response.by_extinction[from]);
                    if (!response.by_absorption.empty())
                        by.col(to + 1) += of_channel * double(response.by_absorption[from]);
                }
            }
        }
    // Of the light paths' level: the fast model tells by what share a colour moves.
    const double level = predicted.sum() / std::max(base.sum(), 1e-9);
    return by * level;
}

Eigen::Vector3d colour_of(const io::JsonObject& object, const char* key) {
    const std::vector<double> rgb = object.numbers(key, 3, -most_colour, most_colour);
    return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace

std::vector<TileCells> tiles_over(const PredictedPrint& print) {
    const Eigen::Vector2d size_mm = print.size().cwiseProduct(print.cell_mm);
    const double edge_mm = std::max(least_tile_mm, std::sqrt(size_mm.prod() / double(most_tiles)));
    const int nx = std::max(1, int(size_mm.x() / edge_mm)), ny = std::max(1, int(size_mm.y() / edge_mm));
    std::vector<TileCells> tiles;
    for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
            const int column = i * print.columns / nx, row = j * print.rows / ny;
            tiles.push_back({column, row, (i + 1) * print.columns / nx - column, (j + 1) * print.rows / ny - row});
        }
    return tiles;
}

std::vector<PrintRegion> regions_of(const PredictedPrint& print, std::span<const Eigen::Vector3f> printed,
                                    std::span<const Eigen::Vector3f> by_paths, std::span<const std::uint8_t> counts) {
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(print.set.channels);
    std::vector<PrintRegion> regions;
    for (const TileCells& tile : tiles_over(print)) {
        PrintRegion region;
        double cells = 0;
        for (int row = tile.row; row < tile.row + tile.rows; ++row)
            for (int column = tile.column; column < tile.column + tile.columns; ++column) {
                const std::size_t cell = print.index(column, row);
                if (!counts[cell]) continue;
                region.printed += printed[cell].cast<double>();
                region.predicted += by_paths[cell].cast<double>();
                cells += 1;
            }
        if (cells < least_share_of_tile * tile.columns * tile.rows) continue;
        region.place = Eigen::Vector2d(2 * tile.column + tile.columns, 2 * tile.row + tile.rows)
                           .cwiseQuotient(print.size())
                           .array() -
                       1;
        region.printed /= cells, region.predicted /= cells;
        region.by_value = changes_over(tile, print.response, weights, region.predicted);
        regions.push_back(std::move(region));
    }
    return regions;
}

std::string region_sheet_text(const RegionSheet& sheet) {
    io::JsonWriter json;
    json.begin_object().add("format", sheet_format).add("version", 1).add("stack", sheet.stack);
    json.add("checker", sheet.has_checker).add("set", io::resin_set_text(sheet.set));
    json.key("regions").begin_list();
    const auto short_number = [](double v) { return std::round(v * 1e6) / 1e6; };
    for (const PrintRegion& region : sheet.regions) {
        json.line().begin_object().add("place", region.place.unaryExpr(short_number).eval());
        json.add("printed", region.printed.unaryExpr(short_number).eval());
        json.add("predicted", region.predicted.unaryExpr(short_number).eval()).key("by_value").begin_list();
        for (Eigen::Index k = 0; k < 3; ++k)
            json.value(Eigen::VectorXd(region.by_value.row(k).transpose().unaryExpr(short_number)));
        json.end_list().end_object();
    }
    json.end_list().end_object();
    return json.text() + "\n";
}

bool is_region_sheet(const std::filesystem::path& file) {
    std::array<char, 64> start{};
    std::ifstream(file, std::ios::binary).read(start.data(), start.size() - 1);
    return std::string_view(start.data()).find(sheet_format) != std::string_view::npos;
}

RegionSheet read_region_sheet(const std::filesystem::path& file) {
    const auto json = io::JsonObject::read(file);
    json.allow_only({"format", "version", "stack", "checker", "set", "regions"});
    if (json.text("format") != sheet_format) json.fail("format", fmt::format("must be {}", sheet_format));
    (void)json.integer("version", 1, 1);
    RegionSheet sheet;
    sheet.stack = json.text("stack");
    sheet.has_checker = json.boolean("checker");
    sheet.set = io::parse_resin_set(json.text("set"), file.string() + ", key `set`");
    const auto values = Eigen::Index(2 * sheet.set.resins.size() * sheet.set.channels.size());
    for (const io::JsonObject& object : json.objects("regions")) {
        object.allow_only({"place", "printed", "predicted", "by_value"});
        const std::vector<double> place = object.numbers("place", 2, -1, 1);
        PrintRegion region{{place[0], place[1]},
                           colour_of(object, "printed"),
                           colour_of(object, "predicted"),
                           Eigen::Matrix3Xd(3, values)};
        const auto rows = object.number_lists("by_value", 3, -most_change, most_change);
        for (Eigen::Index k = 0; k < 3; ++k) {
            if (Eigen::Index(rows[std::size_t(k)].size()) != values)
                object.fail("by_value", fmt::format("must hold three lists of {} numbers, two for each resin of the "
                                                    "set in each channel",
                                                    values));
            for (Eigen::Index v = 0; v < values; ++v) region.by_value(k, v) = rows[std::size_t(k)][std::size_t(v)];
        }
        sheet.regions.push_back(std::move(region));
    }
    return sheet;
}

}  // namespace voxtone::calibration
