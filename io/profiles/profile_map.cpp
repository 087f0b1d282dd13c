// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/profile_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/printable.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/png_pixels.h"
#include "io/profiles/json_channels.h"

namespace voxtone::io {
namespace {

constexpr std::size_t least_samples = 4, most_clusters = 65536;
constexpr std::uint64_t most_picture_bytes = std::uint64_t{1} << 28;

/// A positive length in mm.
void check_length(const JsonObject& json, const char* key, double mm) {
    if (!(mm > 0)) json.fail(key, fmt::format("is {}, expected a length above 0 mm", mm));
}

std::filesystem::path picture_beside(const JsonObject& json, const std::filesystem::path& file) {
    const std::filesystem::path name(json.text("picture"));
    if (name.empty() || name != name.filename() || name == "." || name == "..")
        json.fail("picture",
                  fmt::format("is {}, expected the name of a PNG file in the same folder", json_quoted(name.string())));
    return file.parent_path() / name;
}

std::vector<std::vector<optics::RadialSamples>> targets_of(const JsonObject& json, std::size_t channels) {
    const double spacing = json.number("spacing_mm", 0, 1e6);
    check_length(json, "spacing_mm", spacing);
    auto tables = json.tables("clusters", channels, -1e12, 1e12);
    if (tables.empty() || tables.size() > most_clusters)
        json.fail("clusters", fmt::format("has {} entries, expected 1 to {}", tables.size(), most_clusters));
    const std::size_t length = tables[0][0].size();
    if (length < least_samples)
        json.fail("clusters[0][0]", fmt::format("has {} samples, expected at least {}", length, least_samples));
    std::vector<std::vector<optics::RadialSamples>> targets;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        auto& target = targets.emplace_back();
        for (std::size_t c = 0; c < channels; ++c) {
            if (tables[i][c].size() != length)
                json.fail(fmt::format("clusters[{}][{}]", i, c),
                          fmt::format("has {} samples, clusters[0][0] has {}; all must have as many",
                                      tables[i][c].size(), length));
            target.push_back({spacing, std::move(tables[i][c]), {}});
        }
    }
    return targets;
}

}  // namespace

ProfileMap read_profile_map(const std::filesystem::path& file) {
    const JsonObject json = JsonObject::read(file);
    json.allow_only({"format", "version", "source", "channels", "size_mm", "picture", "spacing_mm", "clusters"});
    if (json.text("format") != "voxtone-profile-map")
        json.fail("format", "is not \"voxtone-profile-map\": this is no profile map");
    if (json.integer("version", 0, 1000000) != 1) json.fail("version", "is not 1, the only version this program knows");
    ProfileMap map;
    if (json.has("source")) map.source = json.text("source");
    map.channels = json_channels(json, "channels");
    const std::vector<double> size = json.numbers("size_mm", 2, 0, 1e6);
    for (const double mm : size) check_length(json, "size_mm", mm);
    map.width_mm = size[0];
    map.height_mm = size[1];
    map.target = targets_of(json, map.channels.size());

    const std::filesystem::path picture_file = picture_beside(json, file);
    map.picture = picture_file.filename().string();
    GreyPicture picture = read_grey_png(read_whole_file(picture_file, most_picture_bytes), picture_file.string());
    map.width_px = picture.width_px;
    map.height_px = picture.height_px;
    map.cluster = std::move(picture.samples);
    for (std::size_t i = 0; i < map.cluster.size(); ++i)
        if (map.cluster[i] >= map.target.size())
            throw InputError(
                fmt::format("{}: pixel ({}, {}) belongs to cluster {}, but {} has {} clusters only, counted from 0",
                            picture_file.string(), i % map.width_px, i / map.width_px, map.cluster[i], file.string(),
                            map.target.size()));
    return map;
}

std::filesystem::path profile_map_picture(const std::filesystem::path& file) {
    return std::filesystem::path(file).replace_extension(".png");
}

void write_profile_map(const ProfileMap& map, const std::filesystem::path& file) {
    VOXTONE_EXPECT(!map.target.empty() && map.target.size() <= most_clusters);
    VOXTONE_EXPECT(map.width_mm > 0 && map.height_mm > 0);
    VOXTONE_EXPECT(std::all_of(map.cluster.begin(), map.cluster.end(), [&](auto i) { return i < map.target.size(); }));
    const optics::RadialSamples& first = map.target.at(0).at(0);
    const std::filesystem::path picture = profile_map_picture(file);
    VOXTONE_EXPECT(picture != file);
    write_whole_file(picture, number_png_bytes(map.width_px, map.height_px, map.cluster));
    JsonWriter json;
    json.begin_object().add("format", "voxtone-profile-map").add("version", 1).add("source", map.source);
    write_channels(json.line().key("channels"), map.channels);
    json.add("size_mm", std::array{map.width_mm, map.height_mm}).add("picture", picture.filename().string());
    json.line().add("spacing_mm", first.spacing_mm);
    json.line().key("clusters").begin_list();
    for (const auto& target : map.target) {
        VOXTONE_EXPECT(target.size() == map.channels.size());
        json.line().begin_list();
        for (const optics::RadialSamples& samples : target) {
            VOXTONE_EXPECT(samples.spacing_mm == first.spacing_mm && samples.light.size() == first.light.size());
            if (&samples != &target.front()) json.line();
            json.value(samples.light);
        }
        json.end_list();
    }
    json.end_list().end_object();
    write_whole_file(file, json.text() + "\n");
}

}  // namespace voxtone::io
