// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/udim.h"

#include <array>
#include "tests/io/models/model_test.h"

namespace {

std::string plain_png(std::uint8_t r, std::uint8_t g, std::uint8_t b) { return png(1, 1, {r, g, b, 255}); }

/// Triangles with all their coordinates at one place each.
std::string triangles_at(const std::vector<Vector2f>& places) {
    std::string obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\n", faces;
    for (std::size_t i = 0; i < places.size(); ++i) {
        obj += "vt " + std::to_string(places[i].x()) + " " + std::to_string(places[i].y()) + "\n";
        const std::string uv = std::to_string(i + 1);
        faces += "f 1/" + uv + " 2/" + uv + " 3/" + uv + "\n";
    }
    return obj + faces;
}

const Vector3f red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), grey(linear(0.5), linear(0.5), linear(0.5));

Files with_map(const std::string& obj, const std::string& map, Files pictures) {
    Files files{{"a.obj", obj}, {"a.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd " + map + "\n"}};
    files.insert(files.end(), pictures.begin(), pictures.end());
    return files;
}

}  // namespace

TEST_CASE("names of UDIM tiles") {
    for (const std::string mark : {"<UDIM>", "<udim>", "$UDIM", "%(UDIM)d", "%3CUDIM%3E"}) {
        CHECK(tile_file("skin." + mark + ".png", {}) == "skin.1001.png");
        CHECK(tile_file("a/skin" + mark + "b.png", {2, 1}) == "a/skin1013b.png");
    }
    for (const std::string mark : {"<UVTILE>", "<uvtile>", "<TILE>", "u<U>_v<V>"})
        CHECK(tile_file("skin_" + mark + ".png", {2, 1}) == "skin_u3_v2.png");
    CHECK_FALSE(tile_file("skin.1001.png", {}));
    CHECK(written_tile("skin.1012.png")->marked == "skin.<UDIM>.png");
    CHECK(written_tile("skin.1012.png")->tile == UvTile{1, 1});
    CHECK(written_tile("2024/skin1001_2000.jpg")->marked == "2024/skin1001_<UDIM>.jpg");  // the last that may be one
    CHECK(written_tile("skin_u2_v3.png")->marked == "skin_<UVTILE>.png");
    CHECK(written_tile("skin_u2_v3.png")->tile == UvTile{1, 2});
    for (const std::string name : {"skin.png", "skin.11001.png", "skin.0999.png", "skin_u0_v1.png", "skin_u11_v1.png"})
        CHECK_FALSE(written_tile(name));
}

TEST_CASE("a face lies in one UDIM tile or in none") {
    const auto tile = [](std::vector<Vector2f> uv) { return tile_of(uv); };
    CHECK(tile({{0, 0}, {1, 0}, {1, 1}}) == UvTile{});
    CHECK(tile({{1, 0}, {2, 0}, {1.5f, 1}}) == UvTile{1, 0});
    CHECK(tile({{9.5f, 3.5f}}) == UvTile{9, 3});
    CHECK(tile({{1.0005f, 0.5f}, {0.2f, 0.5f}}) == UvTile{});  // as near as numbers are written
    CHECK_FALSE(tile({{0.5f, 0.5f}, {1.5f, 0.5f}}));
    CHECK_FALSE(tile({{-0.5f, 0.5f}}));
    CHECK_FALSE(tile({{10.5f, 0.5f}}));
    CHECK_FALSE(tile({{0.5f, 100.5f}}));
    CHECK_FALSE(tile({{std::nanf(""), 0.5f}}));
    CHECK_FALSE(tile({}));
}

TEST_CASE("textures that are cut into tiles") {
    const Folder folder;
    const std::string three = triangles_at({{0.5f, 0.5f}, {1.5f, 0.5f}, {0.5f, 1.5f}});
    SECTION("by a mark in the name") {
        for (const auto& [map, names] : {std::pair{std::string("s.<UDIM>.png"), std::array{"1001", "1002", "1011"}},
                                         {"\"s.$UDIM.png\"", {"1001", "1002", "1011"}},
                                         {"s.<UVTILE>.png", {"u1_v1", "u2_v1", "u1_v2"}}}) {
            CAPTURE(map);
            const Folder own;
            const ModelFile file = read(own, with_map(three, map,
                                                      {{std::string("s.") + names[0] + ".png", plain_png(255, 0, 0)},
                                                       {std::string("s.") + names[1] + ".png", plain_png(0, 255, 0)},
                                                       {std::string("s.") + names[2] + ".png", plain_png(0, 0, 255)}}));
            CHECK(near(corner_colour(file.mesh, 0, 0), red));
            CHECK(near(corner_colour(file.mesh, 1, 0), green));
            CHECK(near(corner_colour(file.mesh, 2, 0), blue));
            CHECK(file.lost_colour.empty());
            CHECK(file.warnings.empty());
        }
    }
    SECTION("coordinates count within their tile, and do not run over its edge") {
        const ModelFile file =
            read(folder, with_map(triangles_at({{1.25f, 0.75f}, {1.75f, 0.25f}, {1.0f + 1 / 64.0f, 0.75f}}),
                                  "s.<UDIM>.png", {{"s.1002.png", four_colours()}}));
        CHECK(near(corner_colour(file.mesh, 0, 0), red));
        CHECK(near(corner_colour(file.mesh, 1, 0), {1, 1, 1}));
        CHECK(near(corner_colour(file.mesh, 2, 0), red));
    }
    SECTION("one tile is named, and its neighbours are there") {
        const Files tiles{{"s.1001.png", plain_png(255, 0, 0)}, {"s.1002.png", plain_png(0, 255, 0)}};
        const std::string two = triangles_at({{0.5f, 0.5f}, {1.5f, 0.5f}});
        const ModelFile file = read(folder, with_map(two, "s.1001.png", tiles));
        CHECK(near(corner_colour(file.mesh, 0, 0), red));
        CHECK(near(corner_colour(file.mesh, 1, 0), green));
        CHECK_THAT(warnings(file), Contains("s.1001.png") && Contains("UDIM"));
        CHECK(file.lost_colour.empty());
        // A repeated picture: faces lie over several tiles, or there is one picture only, or it is another material's.
        const std::string over = two + "vt 0 0\nvt 3 3\nf 1/3 2/4 3/4\n";
        CHECK(near(corner_colour(read(folder, with_map(over, "s.1001.png", tiles)).mesh, 1, 0), red));
        const Folder alone;
        CHECK(near(corner_colour(read(alone, with_map(two, "s.1001.png", {tiles[0]})).mesh, 1, 0), red));
        CHECK(near(corner_colour(read(folder, with_map(triangles_at({{0.5f, 0.5f}}), "s.1002.png", tiles)).mesh, 0, 0),
                   green));
        // Of each of its own: the same either way.
        CHECK(near(corner_colour(read(folder, with_map(triangles_at({{1.5f, 0.5f}}), "s.1002.png", tiles)).mesh, 0, 0),
                   green));
    }
    SECTION("tiles that are missing, and faces over several, are lost") {
        const ModelFile missing = read(folder, with_map(three, "s.<UDIM>.png", {{"s.1001.png", plain_png(255, 0, 0)}}));
        CHECK(near(corner_colour(missing.mesh, 0, 0), red));
        CHECK(near(corner_colour(missing.mesh, 1, 0), grey));
        CHECK_THAT(missing.lost_colour, Contains("s.1002.png") && Contains("s.1011.png") && Contains("LOST"));
        const std::string over = three + "vt 0.5 0.5\nvt 1.5 0.5\nf 1/4 2/5 3/4\n";
        const ModelFile across = read(folder, with_map(over, "s.<UDIM>.png",
                                                       {{"s.1001.png", plain_png(255, 0, 0)},
                                                        {"s.1002.png", plain_png(0, 255, 0)},
                                                        {"s.1011.png", plain_png(0, 0, 255)}}));
        CHECK(near(corner_colour(across.mesh, 3, 0), grey));
        CHECK(near(corner_colour(across.mesh, 2, 0), blue));
        CHECK_THAT(across.lost_colour, Contains("1 faces") && Contains("<UDIM>") && Contains("LOST"));
        const ModelFile bare = read(folder, with_map("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n",
                                                     "s.<UDIM>.png", {{"s.1001.png", plain_png(255, 0, 0)}}));
        CHECK_THAT(bare.lost_colour, Contains("s.1001.png") && Contains("no texture coordinates"));
    }
}
