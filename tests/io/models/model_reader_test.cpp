// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/model_reader.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "base/warning.h"
#include "io/models/mtl_library.h"
#include "io/pictures/texture.h"
#include "tests/io/models/model_test.h"

#ifdef __SANITIZE_ADDRESS__
// OpenImageIO's PNG reader jumps past the destructor of a message when a file is broken. That the leak is its own is
// seen in the whole stack of calls alone.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "fast_unwind_on_malloc=0"; }
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:PNGInput::PngReadCallback\n"; }
#endif

namespace {

const std::string square =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.25\nvt 0.75 0.25\nvt 0.75 0.75\nvt 0.25 0.75\n";

}  // namespace

TEST_CASE("OBJ models") {
    const Folder folder;
    SECTION("texture, Kd that does not multiply it, polygons, welded positions") {
        const ModelFile file = read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3 4/4\n"},
                                             {"a.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd t.png\n"},
                                             {"t.png", four_colours()}});
        CHECK(file.format == "OBJ");
        CHECK(file.mm_per_file_unit == 0);
        CHECK(file.has_colour);
        CHECK(file.warnings.empty());
        CHECK(file.mesh.triangles.size() == 2);
        CHECK(file.mesh.positions.size() == 4);
        for (std::size_t t = 0; t < 2; ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                const Vector3d& p = file.mesh.positions[file.mesh.triangles[t][c]];
                const Vector3f want = p.y() > 0.5 ? (p.x() > 0.5 ? Vector3f(0, 1, 0) : Vector3f(1, 0, 0))
                                                  : (p.x() > 0.5 ? Vector3f(1, 1, 1) : Vector3f(0, 0, 1));
                CHECK(near(corner_colour(file.mesh, t, c), want));
            }
    }
    SECTION("Windows paths, other case, a coloured Kd beside the texture") {
        const ModelFile file = read(folder, {{"a.obj", "mtllib A.MTL\r\n" + square + "usemtl m\r\nf 1/1 2/2 3/3\r\n"},
                                             {"a.mtl", "newmtl m\r\nKd 1 0.5 0\r\nmap_Kd .\\tex\\T.PNG\r\n"},
                                             {"tex/t.png", four_colours()}});
        CHECK(near(corner_colour(file.mesh, 0, 0), {0, 0, 1}));
        CHECK_THAT(warnings(file), Contains("tex/t.png") && Contains("coloured Kd") && Contains("a.mtl"));
    }
    SECTION("a material's colour is sRGB; vertex colours too") {
        const ModelFile file = read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1 2 3\n"},
                                             {"a.mtl", "newmtl m\nKd 0.5 0.25 1\n"}});
        CHECK(near(corner_colour(file.mesh, 0, 1), {linear(0.5), linear(0.25), 1}));
        CHECK(file.has_colour);
        // Blender's are light itself.
        for (const char* first : {"# Blender 3.4.1 MTL File: 'None'", "# Blender MTL File: 'a.blend'"}) {
            const ModelFile blender = read(folder, {{"c.obj", "mtllib c.mtl\n" + square + "usemtl m\nf 1 2 3\n"},
                                                    {"c.mtl", std::string(first) + "\nnewmtl m\nKd 0.5 0.25 1\n"}});
            CHECK(near(corner_colour(blender.mesh, 0, 1), {0.5f, 0.25f, 1}));
            CHECK_THAT(warnings(blender), Contains("written by Blender") && Contains("linear"));
        }
        const ModelFile painted = read(folder, {{"b.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 0 0 1\nf 1 2 3\n"}});
        CHECK(painted.has_colour);
        CHECK(near(corner_colour(painted.mesh, 0, 1), {0, linear(0.5), 0}));
    }
    SECTION("a missing texture or library is said loudly, with its name") {
        const ModelFile file = read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                                             {"a.mtl", "newmtl m\nKd 0 1 0\nmap_Kd gone.png\n"}});
        CHECK(near(corner_colour(file.mesh, 0, 0), {0, 1, 0}));
        CHECK(file.has_colour);
        CHECK_THAT(warnings(file), Contains("gone.png") && Contains("LOST"));
        CHECK_THAT(warnings(read(folder, {{"b.obj", "mtllib gone.mtl\n" + square + "usemtl m\nf 1 2 3\n"}})),
                   Contains("gone.mtl") && Contains("LOST"));
        const ModelFile broken = read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                                               {"a.mtl", "newmtl m\nmap_Kd t.png\n"},
                                               {"t.png", four_colours().substr(0, 60)}});
        CHECK_THAT(warnings(broken), Contains("t.png") && Contains("LOST"));
        CHECK_THAT(warnings(read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1 2 3\n"},
                                          {"t.png", four_colours()}})),
                   Contains("no texture coordinates"));
    }
    SECTION("what is lost is said once, and apart from other warnings") {
        const std::string faces = "usemtl m\nf 1/1 2/2 3/3\nusemtl n\nf 1/1 3/3 4/4\n";
        const ModelFile file = read(folder, {{"a.obj", "mtllib gone.mtl\nmtllib gone.mtl\n" + square + faces}});
        CHECK(std::ranges::count(file.warnings, named_warning("lost-colour", file.lost_colour)) == 1);
        CHECK_THAT(file.lost_colour, Contains("gone.mtl"));
        CHECK(file.lost_colour.find("gone.mtl") == file.lost_colour.rfind("gone.mtl"));
        CHECK(file.warnings.size() == 1);
        const ModelFile many =
            read(folder,
                 {{"a.obj", "mtllib a.mtl\n" + square + faces + "usemtl o\nf 1/1 2/2 4/4\nusemtl p\nf 2/2 3/3 4/4\n"},
                  {"a.mtl",
                   "newmtl m\nmap_Kd 1.png\nnewmtl n\nmap_Kd 2.png\nnewmtl o\nmap_Kd 3.png\nnewmtl p\n"
                   "map_Kd 4.png\n"}});
        CHECK(many.warnings.size() == 1);
        CHECK_THAT(many.lost_colour, Contains("1.png") && Contains("3.png") && Contains("and 1 more"));
        CHECK(read(folder, {{"b.obj", square + "f 1 2 3\n"}}).lost_colour.empty());
    }
    SECTION("a material that is transparent as a whole keeps its colour") {
        const auto one = [&](const std::string& material) {
            return read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                                 {"a.mtl", "newmtl m\n" + material},
                                 {"t.png", four_colours()}});
        };
        for (const std::string transparency : {"Tr 1\n", "d 0\n", "d 0.001\n"}) {
            const ModelFile painted = one("Kd 1 0 0\n" + transparency), pictured = one(transparency + "map_Kd t.png\n");
            CHECK(near(corner_colour(painted.mesh, 0, 0), {1, 0, 0}));
            CHECK(near(corner_colour(pictured.mesh, 0, 0), {0, 0, 1}));
            CHECK_THAT(warnings(painted), Contains("'m'") && Contains("taken to be opaque"));
            CHECK_THAT(warnings(pictured), Contains("'m'") && Contains("taken to be opaque"));
            CHECK(painted.lost_colour.empty());
            CHECK(painted.wants_colour);
        }
        // Half transparent is laid over white, as before; d counts more than Tr, wherever it stands.
        CHECK(near(corner_colour(one("Kd 1 0 0\nd 0.5\n").mesh, 0, 0), {1, 0.5f, 0.5f}));
        for (const std::string both : {"Tr 1\nd 1\n", "d 1\nTr 1\n"}) {
            const ModelFile file = one("Kd 1 0 0\n" + both);
            CHECK(near(corner_colour(file.mesh, 0, 0), {1, 0, 0}));
            CHECK(file.warnings.empty());
        }
    }
    SECTION("materials that the faces do not name are lost colours") {
        const ModelFile file = read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl other\nf 1 2 3\n"},
                                             {"a.mtl", "newmtl m\nKd 1 0 0\n"}});
        CHECK_THAT(file.lost_colour, Contains("none of the materials"));
        CHECK(read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl other\nf 1 2 3\n"},
                            {"a.mtl", "newmtl m\nKd 1 1 1\n"}})
                  .lost_colour.empty());
    }
    SECTION("a texture is given to what has coordinates and no picture") {
        const auto with_texture = [&](const Files& files, const std::string& texture = "given.png") {
            ReadOptions options;
            const std::filesystem::path model = folder.write(files);
            options.texture = folder.write({{texture, four_colours()}});
            return read_model_here(model, options);
        };
        const std::string faces = "usemtl m\nf 1/1 2/2 3/3\n";
        const ModelFile bare = with_texture({{"a.obj", square + "f 1/1 2/2 3/3\n"}});
        CHECK(near(corner_colour(bare.mesh, 0, 0), {0, 0, 1}));
        CHECK(near(corner_colour(bare.mesh, 0, 2), {0, 1, 0}));
        CHECK(bare.has_colour);
        CHECK(bare.warnings.empty());
        // In the place of one that is missing, and of the material's colour, even where that is transparent.
        const ModelFile missing = with_texture(
            {{"a.obj", "mtllib a.mtl\n" + square + faces}, {"a.mtl", "newmtl m\nKd 1 0 0\nd 0\nmap_Kd gone.png\n"}});
        CHECK(near(corner_colour(missing.mesh, 0, 0), {0, 0, 1}));
        CHECK(missing.lost_colour.empty());
        CHECK(missing.warnings.empty());
        // A picture of the file's own stays.
        const std::string two = faces + "usemtl n\nf 1/1 3/3 4/4\n";
        const ModelFile half = with_texture({{"a.obj", "mtllib a.mtl\n" + square + two},
                                             {"a.mtl", "newmtl m\nmap_Kd t.png\nnewmtl n\nKd 1 0 0\n"},
                                             {"t.png", png(1, 1, {0, 0, 0, 255})}});
        CHECK(near(corner_colour(half.mesh, 0, 0), {0, 0, 0}));
        CHECK(near(corner_colour(half.mesh, 1, 0), {0, 0, 1}));
        CHECK_THROWS_WITH(with_texture({{"a.obj", "mtllib a.mtl\n" + square + faces},
                                        {"a.mtl", "newmtl m\nmap_Kd t.png\n"},
                                        {"t.png", four_colours()}}),
                          Contains("of its own"));
        CHECK_THROWS_WITH(with_texture({{"a.obj", square + "f 1 2 3\n"}}), Contains("no texture coordinates"));
        ReadOptions nothing;
        nothing.texture = folder.path() / "nothing.png";
        CHECK_THROWS_AS(read_model_here(folder.write({{"a.obj", square + "f 1/1 2/2 3/3\n"}}), nothing), FileError);
    }
    SECTION("texels are blended unless the user or the file wants the nearest one") {
        const std::filesystem::path obj =
            folder.write({{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"},
                          {"a.mtl", "newmtl m\nmap_Kd t.png\n"},
                          {"t.png", four_colours()}});
        const auto between = [&](const std::filesystem::path& file, TextureFilter filter) {
            ReadOptions options;
            options.texture_filter = filter;
            const ModelFile model = read_model_here(file, options);
            return model.mesh.materials.back().texture->sample(0.49f, 0.75f);  // red on the left, green on the right
        };
        CHECK(near(between(obj, TextureFilter::nearest), {1, 0, 0}));
        CHECK(near(between(obj, TextureFilter::linear), {0.52f, 0.48f, 0}, 0.01f));
        CHECK(near(between(obj, TextureFilter::as_file), between(obj, TextureFilter::linear)));
        ReadOptions options;
        options.texture_filter = TextureFilter::nearest;
        const Picture sharp = read_picture_here(folder.path() / "t.png", options);
        CHECK(near(sharp.texture->sample(0.49f, 0.75f), {1, 0, 0}));
        CHECK_FALSE(read_picture_here(folder.path() / "t.png").texture->nearest());
    }
    SECTION("textures outside the folder are not read") {
        Folder inner;
        const std::filesystem::path outside = folder.write({{"secret.png", four_colours()}});
        const ModelFile file =
            read(inner, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                         {"a.mtl", fmt::format("newmtl m\nmap_Kd {}\nnewmtl n\nmap_Kd ../{}/secret.png\n",
                                               outside.string(), folder.path().filename().string())}});
        for (const SurfaceMaterial& material : file.mesh.materials) CHECK_FALSE(material.texture);
        CHECK_THAT(warnings(file), Contains("secret.png") && Contains("not found"));
    }
    SECTION("map options: offset, scale, clamp, blanks in names") {
        const auto materials = parse_mtl(
            "newmtl a b\nmap_Kd -clamp on -s 2 3 1 -o 0.5 -bm 1 my file.png\nd 0.5\nnewmtl c\nTr 0.25\nKd x 1 "
            "1\nmap_Kd -x.png\n");
        REQUIRE(materials.size() == 2);
        CHECK(materials[0].name == "a b");
        CHECK(materials[0].map_kd == "my file.png");
        CHECK(materials[0].map_clamp);
        CHECK(materials[0].map_scale == Vector2f(2, 3));
        CHECK(materials[0].map_offset == Vector2f(0.5f, 0));
        CHECK(materials[0].opacity == 0.5f);
        CHECK(materials[1].opacity == 0.75f);
        CHECK_FALSE(materials[1].kd);
        CHECK(materials[1].map_kd == "-x.png");
        const ModelFile file = read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                                             {"a.mtl", "newmtl m\nmap_Kd -o 0.5 0 t.png\n"},
                                             {"t.png", four_colours()}});
        CHECK(near(corner_colour(file.mesh, 0, 0), {1, 1, 1}));  // was blue, half a picture further right is white
    }
    SECTION("transparency is laid over white and said") {
        const ModelFile file =
            read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                          {"a.mtl", "newmtl m\nmap_Kd t.png\n"},
                          {"t.png", png(2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 51, 255, 255, 255, 0})}});
        CHECK(near(corner_colour(file.mesh, 0, 0), {0.8f, 0.8f, 1}, 5e-3f));
        CHECK_THAT(warnings(file), Contains("over white"));
    }
    SECTION("what is no model gives a clear error") {
        const auto error = [&](const std::string& text) {
            return refusal_by([&] { return read(folder, {{"bad.obj", text}}); });
        };
        CHECK_THAT(error(""), Contains("empty"));
        CHECK_THAT(error("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), Contains("bad.obj"));
        CHECK_THAT(error(square + "l 1 2\np 1\n"), Contains("no faces"));
        CHECK_THAT(error(square + "f 1 2 9\n"), Contains("bad.obj"));
        CHECK_THAT(error(square + "f 1 2 -9\n"), Contains("bad.obj"));
        CHECK_THAT(error("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), Contains("infinite or not numbers"));
        CHECK_THAT(error("v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n"), Contains("infinite or not numbers"));
        CHECK_THROWS_AS(read_model(folder.path() / "nothing.obj"), FileError);
        CHECK_THROWS_WITH(read_model(folder.path()), Contains("no model"));
        CHECK_THROWS_WITH(read_model(folder.write({{"a.dae", "<COLLADA>"}})), Contains("OBJ, PLY, STL"));
        ReadOptions options;
        options.timeout_s = 0;
        CHECK_THROWS_AS(read_model("x.obj", options), UsageError);
    }
    SECTION("points and lines beside faces are left aside") {
        const ModelFile file = read(folder, {{"a.obj", square + "f 1 2 3\nl 1 2 3\n"}});
        CHECK(file.mesh.triangles.size() == 1);
        CHECK_THAT(warnings(file), Contains("lines"));
    }
}

TEST_CASE("PLY and STL models") {
    const Folder folder;
    const auto ply = [](const std::string& type, const std::string& colour, const std::string& comment = "") {
        return "ply\nformat ascii 1.0\n" + comment +
               "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty " + type +
               " red\nproperty " + type + " green\nproperty " + type +
               " blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 " + colour +
               "\n1 0 0 " + colour + "\n0 1 0 " + colour + "\n3 0 1 2\n";
    };
    SECTION("bytes and floats are sRGB codes") {
        const ModelFile bytes = read(folder, {{"a.ply", ply("uchar", "128 0 255")}});
        CHECK(bytes.has_colour);
        CHECK(near(corner_colour(bytes.mesh, 0, 0), {linear(128 / 255.0), 0, 1}, 1e-5f));
        CHECK(near(corner_colour(read(folder, {{"a.ply", ply("float", "0.5 0 1")}}).mesh, 0, 2), {linear(0.5), 0, 1},
                   1e-5f));
    }
    SECTION("sizes that the file cannot hold are refused before they are believed") {
        std::string text = ply("uchar", "1 2 3");
        text.replace(text.find("vertex 3"), 8, "vertex 3000000000");
        CHECK_THROWS_WITH(read(folder, {{"a.ply", text}}), Contains("3000000000"));
        CHECK_THROWS_WITH(read(folder, {{"a.ply", "ply\nformat ascii 1.0\n"}}), Contains("header"));
    }
    SECTION("indices out of range, numbers that are none") {
        std::string text = ply("uchar", "1 2 3");
        text.replace(text.find("3 0 1 2"), 7, "3 0 1 7");
        CHECK_THROWS_AS(read(folder, {{"a.ply", text}}), InputError);
    }
    SECTION("a face without corners among triangles") {
        std::string text = ply("uchar", "1 2 3");
        text.replace(text.find("face 1"), 6, "face 2");
        const ModelFile file = read(folder, {{"a.ply", text + "0\n"}});
        CHECK(file.mesh.triangles.size() == 1);
        CHECK_THAT(warnings(file), Contains("points or lines"));
    }
    SECTION("STL: text and binary; attribute words are no colour") {
        for (const Files& sample : every_sample()) {
            if (!sample[0].first.ends_with(".stl")) continue;
            const ModelFile file = read(folder, sample);
            CHECK(file.format == "STL");
            CHECK_FALSE(file.has_colour);
            CHECK(file.warnings.empty());
            CHECK(file.mesh.corner_rgb.empty());
            CHECK(file.mesh.triangles.size() == (sample[0].first == "a.stl" ? 1 : 2));
            CHECK(file.mesh.positions.size() == (sample[0].first == "a.stl" ? 3 : 4));
        }
        const auto stl = [](const std::string& header, std::vector<std::uint16_t> words, std::uint32_t declared) {
            std::string text =
                header + std::string(80 - header.size(), ' ') + raw(std::vector<std::uint32_t>{declared});
            for (const std::uint16_t word : words)
                text +=
                    raw(std::vector<float>{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw(std::vector<std::uint16_t>{word});
            return text;
        };
        CHECK_THAT(warnings(read(folder, {{"c.stl", stl("", {0x8fff, 0x801f}, 2)}})),
                   Contains("VisCAM") && Contains("LOST"));
        CHECK_THAT(warnings(read(folder, {{"c.stl", stl("COLOR=\1\2\3\4", {0, 0}, 2)}})), Contains("Magics"));
        CHECK(read(folder, {{"c.stl", stl("", {0x2020, 0x2020}, 2)}}).warnings.empty());
        CHECK_THROWS_WITH(read(folder, {{"c.stl", stl("", {0, 0}, 0x10000000)}}), Contains("cut short"));
        for (const std::uint32_t left_open : {0U, 0xFFFFFFFFU}) {
            const ModelFile file = read(folder, {{"c.stl", stl("", {0, 0}, left_open)}});
            CHECK(file.mesh.triangles.size() == 2);
            CHECK_THAT(warnings(file), Contains("bytes for 2: all were read") && Contains("[damaged]"));
        }
        CHECK_THAT(warnings(read(folder, {{"c.stl", stl("", {0, 0}, 1)}})), Contains("was left aside"));
    }
}

TEST_CASE("OBJ as the world writes it") {
    const Folder folder;
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto first = [&](const Files& files) { return corner_colour(read(folder, files).mesh, 0, 0); };
    const Vector3f red(linear(200 / 255.0), linear(40 / 255.0), linear(40 / 255.0));
    SECTION("colours of vertices, in every form, stay with their vertices") {
        for (const std::string line : {"v 0 0 0 0.784314 0.156863 0.156863", "v 0 0 0 200 40 40",
                                       "v 0 0 0 0.784314 0.156863 0.156863 1", "v 0 0 0 1 0.784314 0.156863 0.156863",
                                       "v 0 0 0 1 0.784314 0.156863 0.156863 1", "v 0 0 0 51400 10280 10280"}) {
            CAPTURE(line);
            CHECK(near(first({{"a.obj", line + "\n" + line + "\n" + line + "\nf 1 2 3\n"}}), red, 2e-3f));
        }
        // Only the second has one.
        const ModelFile mixed = read(folder, {{"b.obj", "v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n"}});
        CHECK(near(corner_colour(mixed.mesh, 0, 0), {1, 1, 1}));
        CHECK(near(corner_colour(mixed.mesh, 0, 1), {1, 0, 0}));
        const ModelFile painted =
            read(folder, {{"c.obj", triangle + "f 1 2 3\n#MRGB ffc82828ff00ff00\n#MRGB ff0000ff\n"}});
        CHECK(near(corner_colour(painted.mesh, 0, 0), red));
        CHECK(near(corner_colour(painted.mesh, 0, 1), {0, 1, 0}));
        CHECK(near(corner_colour(painted.mesh, 0, 2), {0, 0, 1}));
    }
    SECTION("vertex colours come before Kd, and a texture before both") {
        const std::string grey = "v 0 0 0 0.5 0.5 0.5\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 0.5 0.5 0.5\n";
        const Files mtl{{"a.mtl", "newmtl m\nKd 0 0 0\n"}};
        CHECK(near(first({{"a.obj", "mtllib a.mtl\n" + grey + "usemtl m\nf 1 2 3\n"}, mtl[0]}),
                   Vector3f::Constant(linear(0.5))));
        const ModelFile both =
            read(folder, {{"a.obj", "mtllib a.mtl\n" + grey + "vt 0.25 0.25\nusemtl m\nf 1/1 2/1 3/1\n"},
                          {"a.mtl", "newmtl m\nmap_Kd t.png\n"},
                          {"t.png", four_colours()}});
        CHECK(near(corner_colour(both.mesh, 0, 0), {0, 0, 1}));
        CHECK_THAT(warnings(both), Contains("the textures are printed"));
    }
    SECTION("text with marks, in UTF-16, joined, indented, with comments, commas and any line end") {
        const std::string mtl = "newmtl m # first\r\n\tKd 0,784314 0,156863 0,156863 # red\r\n";
        const auto with = [&](const std::string& obj, const std::string& library = "") {
            return first({{"a.obj", obj}, {"a.mtl", library.empty() ? mtl : library}});
        };
        const std::string body = "mtllib a.mtl\n" + triangle + "usemtl m\nf 1 2 3\n";
        CHECK(near(with("\xEF\xBB\xBF" + body), red, 1e-3f));
        CHECK(near(with(body, "\xEF\xBB\xBF" + mtl), red, 1e-3f));
        CHECK(near(with("mtllib a.mtl # colours\n  v 0,0 0 0\n\tv 1 0 0\nv 0 1 0\nusemtl m\nf 1 \\\n2 \\ \n3\n"), red,
                   1e-3f));
        std::string carriage = body;
        std::ranges::replace(carriage, '\n', '\r');
        CHECK(near(with(carriage), red, 1e-3f));
        for (const bool big : {false, true}) {
            std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
            for (const char c : body) wide += big ? std::string{'\0', c} : std::string{c, '\0'};
            CHECK(near(with(wide), red, 1e-3f));
            std::string widest = big ? std::string("\0\0\xFE\xFF", 4) : std::string("\xFF\xFE\0\0", 4);
            for (const char c : body)
                widest += big ? std::string{'\0', '\0', '\0', c} : std::string{c, '\0', '\0', '\0'};
            CHECK(near(with(widest), red, 1e-3f));
        }
    }
    SECTION("libraries by names that are not quite theirs, several in a line") {
        const std::string faces = triangle + "usemtl M\nf 1 2 3\n";
        for (const std::string name :
             {"my%20own.mtl", "\"my own.mtl\"", "my own.mtl ", "my\\ own.mtl", "my own.mtl other.mtl"}) {
            CAPTURE(name);
            CHECK(near(first({{"a.obj", "mtllib " + name + "\n" + faces},
                              {"my own.mtl", "newmtl m\nKd 1 0 0\n"},
                              {"own.mtl", "newmtl m\nKd 1 0 0\n"}}),
                       {1, 0, 0}));
        }
        CHECK(near(first({{"a.obj", "mtllib n\xE4he.mtl\n" + faces}, {"n\xC3\xA4he.mtl", "newmtl m\nKd 1 0 0\n"}}),
                   {1, 0, 0}));
    }
    SECTION("no library is named: the one that is called as the model is, or a word") {
        const std::string model = triangle + "usemtl m\nf 1 2 3\n";
        const ModelFile taken = read(folder, {{"a.obj", model}, {"a.mtl", "newmtl m\nKd 1 0 0\n"}});
        CHECK(near(corner_colour(taken.mesh, 0, 0), {1, 0, 0}));
        CHECK_THAT(warnings(taken), Contains("'a.mtl' beside it was taken"));
        const ModelFile none = read(folder, {{"b.obj", model}});
        CHECK(none.lost_colour.empty());
        CHECK_THAT(warnings(none), Contains("mtllib"));
        CHECK(read(folder, {{"b.obj", triangle + "f 1 2 3\n"}}).warnings.empty());
    }
    SECTION("a Kd that is no red, green and blue is lost, unless something else is printed") {
        const std::string model = "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n";
        for (const std::string kd : {"spectral red.rfl 1", "xyz 0.4 0.2 0.1", "red"}) {
            CAPTURE(kd);
            CHECK_THAT(read(folder, {{"a.obj", model}, {"a.mtl", "newmtl m\nKd " + kd + "\n"}}).lost_colour,
                       Contains("'" + kd + "'") && Contains("'m'"));
            CHECK(read(folder, {{"a.obj", model},
                                {"a.mtl", "newmtl m\nmap_Kd t.png\nKd " + kd + "\n"},
                                {"t.png", four_colours()}})
                      .lost_colour.empty());
        }
    }
    SECTION("a material that is there twice: the last of a library, of the first library") {
        const std::string red_last = "newmtl m\nKd 0 1 0\nnewmtl n\nKd 0 0 1\nnewmtl m\nKd 1 0 0\n";
        const ModelFile twice = read(folder, {{"a.obj", "mtllib a.mtl b.mtl\n" + triangle + "usemtl m\nf 1 2 3\n"},
                                              {"a.mtl", red_last},
                                              {"b.mtl", "newmtl m\nKd 0 0 1\n"}});
        CHECK(near(corner_colour(twice.mesh, 0, 0), {1, 0, 0}));
        CHECK_THAT(warnings(twice), Contains("'m' several times") && Contains("a.mtl"));
    }
    SECTION("colours that unlit exporters put elsewhere") {
        const auto of = [&](const std::string& material) {
            return first({{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"},
                          {"a.mtl", "newmtl m\n" + material},
                          {"t.png", four_colours()}});
        };
        CHECK(near(of("Ka 1 1 1\nKd 0.8 0.8 0.8\nmap_Ka t.png\n"), {0, 0, 1}));
        CHECK(near(of("Kd 0 0 0\nKe 1 1 1\nmap_Ke t.png\n"), {0, 0, 1}));
        CHECK(near(of("Kd 0 0 0\nKa 1 0 0\n"), {1, 0, 0}));
        CHECK(near(of("Kd 0 0 0\nKe 0 1 0\n"), {0, 1, 0}));
        CHECK(near(of("Kd 0 0 0\nKa 1 1 1\nKe 0 0 0\n"), {0, 0, 0}));  // black, as most write it
        CHECK(near(of("Kd 255 0 0\n"), {1, 0, 0}));
    }
    SECTION("what some faces lack is said") {
        const ModelFile half =
            read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3\nf 1 3 4\n"},
                          {"a.mtl", "newmtl m\nKd 1 0 0\nmap_Kd t.png\n"},
                          {"t.png", four_colours()}});
        CHECK(near(corner_colour(half.mesh, 0, 0), {0, 0, 1}));
        CHECK(near(corner_colour(half.mesh, 1, 0), {1, 0, 0}));
        CHECK_THAT(half.lost_colour, Contains("1 faces") && Contains("'m'"));
        const ModelFile unknown =
            read(folder, {{"a.obj", "mtllib a.mtl\n" + square + "usemtl m\nf 1 2 3\nusemtl blue\nf 1 3 4\n"},
                          {"a.mtl", "newmtl m\nKd 1 0 0\n"}});
        CHECK_THAT(unknown.lost_colour, Contains("'blue'"));
    }
    SECTION("a ball far from its origin stays a ball") {
        const ModelFile far = read(folder, {{"a.obj",
                                             "v 500000.1 5400000.1 200.3\nv 500000.2 5400000.1 200.3\n"
                                             "v 500000.1 5400000.2 200.3\nf 1 2 3\n"}});
        CHECK((far.mesh.positions[far.mesh.triangles[0][1]] - far.mesh.positions[far.mesh.triangles[0][0]] -
               Vector3d(0.1, 0, 0))
                  .norm() < 1e-8);
    }
    SECTION("concave polygons, and holes that are joined by a bridge") {
        const auto area = [&](const std::string& text) {
            const ModelFile file = read(folder, {{"a.obj", text}});
            double sum = 0;
            for (const auto& t : file.mesh.triangles)
                sum += 0.5 * (file.mesh.positions[t[1]] - file.mesh.positions[t[0]])
                                 .cross(file.mesh.positions[t[2]] - file.mesh.positions[t[0]])
                                 .norm();
            return sum;
        };
        CHECK(area("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n") == Approx(10));
        CHECK(area("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 3 1 0\nv 3 3 0\nv 1 3 0\nf 1 2 3 4 1 5 8 7 6 5\n") ==
              Approx(12));
    }
}

TEST_CASE("PLY and STL as the world writes them") {
    const Folder folder;
    const Vector3f red(linear(200 / 255.0), linear(40 / 255.0), linear(40 / 255.0));
    const auto ply = [](const std::string& type, const std::string& colour, const std::string& prefix = "") {
        std::string text =
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n";
        for (const char* name : {"red", "green", "blue"}) text += "property " + type + " " + prefix + name + "\n";
        text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
        for (const char* place : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) text += place + colour + "\n";
        return text + "3 0 1 2\n";
    };
    SECTION("colours of every type") {
        for (const auto& [type, colour] : {std::pair{"uchar", "200 40 40"},
                                           {"char", "-56 40 40"},
                                           {"ushort", "200 40 40"},
                                           {"ushort", "51400 10280 10280"},
                                           {"short", "-14136 10280 10280"},
                                           {"int", "200 40 40"},
                                           {"uint", "200 40 40"},
                                           {"float", "0.784314 0.156863 0.156863"},
                                           {"double", "200 40 40"}}) {
            CAPTURE(type, colour);
            CHECK(near(corner_colour(read(folder, {{"a.ply", ply(type, colour)}}).mesh, 0, 0), red, 2e-3f));
        }
        CHECK(near(corner_colour(read(folder, {{"a.ply", ply("uchar", "200 40 40", "diffuse_")}}).mesh, 0, 0), red));
        CHECK_THAT(read(folder, {{"a.ply", ply("uchar", "200 40 40", "specular_")}}).lost_colour,
                   Contains("specular_red"));
    }
    SECTION("line ends, a mark, strips and pages") {
        std::string carriage = ply("uchar", "200 40 40");
        std::ranges::replace(carriage, '\n', '\r');
        CHECK(near(corner_colour(read(folder, {{"a.ply", carriage}}).mesh, 0, 0), red));
        CHECK(
            near(corner_colour(read(folder, {{"a.ply", "\xEF\xBB\xBF" + ply("uchar", "200 40 40")}}).mesh, 0, 0), red));
        const std::string vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
        const ModelFile strips =
            read(folder,
                 {{"s.ply", "ply\nformat ascii 1.0\n" + vertices +
                                "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n"
                                "0 1 0\n1 1 0\n8 0 1 2 3 -1 3 2 1\n"}});
        REQUIRE(strips.mesh.triangles.size() == 3);
        for (const std::size_t t : {0, 1}) {
            const auto& c = strips.mesh.triangles[t];
            CHECK((strips.mesh.positions[c[1]] - strips.mesh.positions[c[0]])
                      .cross(strips.mesh.positions[c[2]] - strips.mesh.positions[c[0]])
                      .z() > 0);
        }
        const ModelFile pages = read(
            folder, {{"p.ply",
                      "ply\nformat ascii 1.0\ncomment TextureFile r.png\ncomment TextureFile t.png\n" + vertices +
                          "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                          "property int texnumber\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
                          "3 0 1 2 6 0.25 0.25 0.25 0.25 0.25 0.25 1\n3 1 3 2 6 0.25 0.25 0.25 0.25 0.25 0.25 0\n"},
                     {"r.png", png(1, 1, {255, 0, 0, 255})},
                     {"t.png", four_colours()}});
        CHECK(near(corner_colour(pages.mesh, 0, 0), {0, 0, 1}));
        CHECK(near(corner_colour(pages.mesh, 1, 0), {1, 0, 0}));
    }
    SECTION("STL in capitals, behind blanks, with commas and without line ends") {
        const std::string text =
            "  SOLID facet\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1,5 0 0\nVERTEX 0 1 "
            "0\nENDLOOP\nENDFACET\nENDSOLID";
        const ModelFile file = read(folder, {{"a.stl", text}});
        REQUIRE(file.mesh.triangles.size() == 1);
        CHECK(file.mesh.positions[file.mesh.triangles[0][1]].x() == 1.5);
        CHECK_THROWS_WITH(read(folder, {{"a.stl", text.substr(0, text.find("VERTEX 0 1 0"))}}), Contains("cut short"));
    }
}

TEST_CASE("PLY faces have colours and texture coordinates of their own") {
    const Folder folder;
    const std::string vertices = "property float x\nproperty float y\nproperty float z\n",
                      face_list = "property list uchar int vertex_indices\n";
    const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    SECTION("colours, where polygons are cut into triangles") {
        const std::string text = "ply\nformat ascii 1.0\nelement vertex 5\n" + vertices + "element face 2\n" +
                                 face_list + rgb +
                                 "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n4 0 1 2 3 255 0 0\n3 1 4 2 0 128 0\n";
        const ModelFile file = read(folder, {{"a.ply", text}});
        REQUIRE(file.mesh.triangles.size() == 3);
        CHECK(file.has_colour);
        CHECK(file.wants_colour);
        CHECK(file.lost_colour.empty());
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(near(corner_colour(file.mesh, 0, c), {1, 0, 0}));
            CHECK(near(corner_colour(file.mesh, 1, c), {1, 0, 0}));
            CHECK(near(corner_colour(file.mesh, 2, c), {0, linear(128 / 255.0), 0}));
        }
        CHECK_THROWS_AS(read(folder, {{"a.ply", text.substr(0, text.size() - 8)}}), InputError);
    }
    SECTION("binary, both byte orders, floats; behind another element with a list") {
        const auto bytes = [&](auto value, bool big) {
            std::string raw_value = raw(std::vector{value});
            if (big) std::reverse(raw_value.begin(), raw_value.end());
            return raw_value;
        };
        for (const bool big : {false, true}) {
            std::string text = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                               "_endian 1.0\nelement vertex 3\n" + vertices + "element face 1\n" + face_list +
                               "property float red\nproperty float green\nproperty float blue\nend_header\n";
            for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) text += bytes(x, big);
            text += '\3';
            for (const std::int32_t v : {0, 1, 2}) text += bytes(v, big);
            for (const float x : {0.25f, 0.5f, 0.f}) text += bytes(x, big);
            const ModelFile file = read(folder, {{"b.ply", text}});
            for (std::size_t c = 0; c < 3; ++c)
                CHECK(near(corner_colour(file.mesh, 0, c), {linear(0.25), linear(0.5), 0}));
        }
    }
    SECTION("colours of vertices stay where they differ, and give way where they are all alike") {
        const auto both = [&](const std::string& second_vertex) {
            return read(folder,
                        {{"c.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" + vertices + rgb + "element face 2\n" +
                                       face_list + rgb + "end_header\n0 0 0 255 255 255\n1 0 0 " + second_vertex +
                                       "\n0 1 0 255 255 255\n1 1 0 255 255 255\n3 0 1 2 255 0 0\n3 1 3 2 0 0 255\n"}});
        };
        const ModelFile alike = both("255 255 255"), differ = both("0 255 0");
        CHECK(near(corner_colour(alike.mesh, 0, 1), {1, 0, 0}));
        CHECK(near(corner_colour(alike.mesh, 1, 0), {0, 0, 1}));
        CHECK(alike.warnings.empty());
        CHECK(near(corner_colour(differ.mesh, 0, 1), {0, 1, 0}));
        CHECK_THAT(warnings(differ), Contains("of vertices and of faces"));
    }
    SECTION("coordinates: two faces at one edge may tear there") {
        const ModelFile file =
            read(folder,
                 {{"d.ply", "ply\nformat ascii 1.0\ncomment texturefile   t.png \nelement vertex 4\n" + vertices +
                                "element face 2\n" + face_list +
                                "property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
                                "3 0 1 2 6 0.25 0.25 0.25 0.25 0.25 0.25\n3 1 3 2 6 0.75 0.25 0.25 0.75 0.75 0.75\n"},
                  {"t.png", four_colours()}});
        for (std::size_t c = 0; c < 3; ++c) CHECK(near(corner_colour(file.mesh, 0, c), {0, 0, 1}));
        CHECK(near(corner_colour(file.mesh, 1, 0), {1, 1, 1}));
        CHECK(near(corner_colour(file.mesh, 1, 1), {1, 0, 0}));
        CHECK(near(corner_colour(file.mesh, 1, 2), {0, 1, 0}));
    }
    SECTION("what the header does not tell of is left aside with a word") {
        const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n" + vertices + "element face 1\n" +
                                 face_list + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        CHECK_THAT(warnings(read(folder, {{"e.ply", head + "3 2 1 0\n"}})), Contains("goes on behind"));
        CHECK(warnings(read(folder, {{"e.ply", head + " \n"}})).find("goes on behind") == std::string::npos);
    }
    SECTION("what is transparent keeps its colour; transparent black is no colour") {
        const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n" + vertices + rgb +
                                 "property uchar alpha\nelement face 1\n" + face_list + "end_header\n";
        const ModelFile some =
            read(folder, {{"e.ply", head + "0 0 0 255 0 0 0\n1 0 0 0 0 0 0\n0 1 0 0 255 0 255\n3 0 1 2\n"}});
        CHECK(near(corner_colour(some.mesh, 0, 0), {1, 0, 0}));
        CHECK(near(corner_colour(some.mesh, 0, 1), {1, 1, 1}));
        CHECK(near(corner_colour(some.mesh, 0, 2), {0, 1, 0}));
        CHECK_THAT(warnings(some), Contains("1 corners") && Contains("taken to be opaque"));
        const ModelFile all =
            read(folder, {{"e.ply", head + "0 0 0 255 0 0 0\n1 0 0 0 0 0 0\n0 1 0 0 255 0 0\n3 0 1 2\n"}});
        CHECK(near(corner_colour(all.mesh, 0, 1), {0, 0, 0}));
        CHECK(near(corner_colour(all.mesh, 0, 2), {0, 1, 0}));
        const ModelFile none =
            read(folder, {{"e.ply", head + "0 0 0 0 0 0 0\n1 0 0 0 0 0 0\n0 1 0 0 0 0 0\n3 0 1 2\n"}});
        for (std::size_t c = 0; c < 3; ++c) CHECK(near(corner_colour(none.mesh, 0, c), {1, 1, 1}));
        CHECK_FALSE(none.wants_colour);
    }
    SECTION("items that hold nothing, and a comment that seems to end the header") {
        const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n" + vertices;
        const std::string rest = "element face 1\n" + face_list + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        CHECK_THROWS_WITH(read(folder, {{"f.ply", head + "element nothing 999999999\n" + rest}}),
                          Contains("999999999 items 'nothing' that hold nothing"));
        CHECK(read(folder, {{"f.ply", head + "element nothing 0\n" + rest}}).mesh.triangles.size() == 1);
        CHECK_THROWS_WITH(read(folder, {{"f.ply", head + "comment end_header\nelement face 999999999\n" + face_list +
                                                      "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}}),
                          Contains("999999999 items 'face'"));
        CHECK_THROWS_WITH(read(folder, {{"f.ply", head + "element face 1\n" + face_list +
                                                      "end_header\n0 0 0\n1 0 0\n0 1 0\n9999999999 0 1 2\n"}}),
                          Contains("a list in it has no length"));
        CHECK_THROWS_WITH(read(folder, {{"f.ply", "ply\nformat ascii 1.0\nend_headers\nelement vertex 3\n" + rest}}),
                          Contains("'end_headers', which PLY does not know"));
    }
}

TEST_CASE("3MF models", "[slow]") {
    const Folder folder;
    const std::string colours =
        R"(<q:colorgroup id="1"><q:color color="#FF0000"/><q:color color="#00FF00FF"/><q:color color="#808080"/></q:colorgroup>)";
    const auto object = [](const std::string& attributes, double size, const std::vector<std::string>& triangles = {}) {
        return fmt::format("<object {}>{}</object>", attributes, threemf_tetrahedron(size, triangles));
    };
    const auto read3 = [&](const std::string& resources, const std::string& build, const Files& others = {},
                           const std::string& unit = "millimeter", const std::string& attributes = "") {
        return read(folder, {{"a.3mf", threemf(resources, build, others, unit, attributes)}});
    };
    SECTION("units") {
        for (const auto& [unit, mm] : {std::pair{"micron", 0.001},
                                       {"millimeter", 1.0},
                                       {"centimeter", 10.0},
                                       {"inch", 25.4},
                                       {"foot", 304.8},
                                       {"meter", 1000.0}})
            CHECK(read3(object(R"(id="2")", 1), R"(<item objectid="2"/>)", {}, unit).mm_per_file_unit == mm);
        CHECK_THROWS_WITH(read3(object(R"(id="2")", 1), R"(<item objectid="2"/>)", {}, "parsec"), Contains("parsec"));
    }
    SECTION("an id that is given twice would lose a body or its colours") {
        const std::string item = R"(<item objectid="2"/>)", body = object(R"(id="2")", 1);
        CHECK_THROWS_WITH(read3(body + object(R"(id="2")", 2), item), Contains("<object> has the id 2"));
        CHECK_THROWS_WITH(read3(colours + colours + body, item), Contains("colorgroup> has the id 1"));
    }
    SECTION("colours: per corner, per triangle, per object") {
        const ModelFile file =
            read3(colours + object(R"(id="2" pid="1" pindex="2")", 1,
                                   {R"(pid="1" p1="0" p2="1" p3="2")", R"(pid="1" p1="1")", R"(p1="0")"}),
                  R"(<item objectid="2"/>)");
        CHECK(file.has_colour);
        CHECK(file.warnings.empty());
        const float grey = linear(128 / 255.0);
        CHECK(near(corner_colour(file.mesh, 0, 0), {1, 0, 0}));
        CHECK(near(corner_colour(file.mesh, 0, 1), {0, 1, 0}));
        CHECK(near(corner_colour(file.mesh, 0, 2), {grey, grey, grey}));
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(near(corner_colour(file.mesh, 1, c), {0, 1, 0}));
            CHECK(near(corner_colour(file.mesh, 2, c), {1, 0, 0}));
            CHECK(near(corner_colour(file.mesh, 3, c), {grey, grey, grey}));
        }
    }
    SECTION("base materials have no gradients; composites are mixed and reported") {
        const ModelFile file = read3(
            R"(<basematerials id="1"><base name="a" displaycolor="#FF0000"/><base name="b" displaycolor="#0000FF"/></basematerials>)"
            R"(<q:compositematerials id="3" matid="1" matindices="0 1"><q:composite values="1 3"/></q:compositematerials>)" +
                object(R"(id="2")", 1, {R"(pid="1" p1="1" p2="0" p3="0")", R"(pid="3" p1="0")"}),
            R"(<item objectid="2"/>)");
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(near(corner_colour(file.mesh, 0, c), {0, 0, 1}));
            CHECK(near(corner_colour(file.mesh, 1, c), {0.25f, 0, 0.75f}));
            CHECK(near(corner_colour(file.mesh, 2, c), {1, 1, 1}));
        }
        CHECK_THAT(warnings(file), Contains("composite") && Contains("LOST"));
    }
    SECTION("build items, nested components, transforms; a mirror keeps the outside out") {
        const ModelFile file = read3(
            object(R"(id="2")", 1) +
                R"(<object id="3"><components><component objectid="2" transform="2 0 0 0 3 0 0 0 -1 10 0 0"/></components></object>)",
            R"(<item objectid="2"/><item objectid="3" transform="0 1 0 -1 0 0 0 0 1 0 0 100"/>)");
        REQUIRE(file.mesh.triangles.size() == 8);
        CHECK(volume_of(file.mesh) == Approx(1 / 6.0 + 1));
        // (1, 0, 0) of the component goes to (12, 0, 0), then by the item (x, y, z) -> (-y, x, z + 100) to (0, 12,
        // 100).
        bool found = false;
        for (const Vector3d& p : file.mesh.positions) found |= (p - Vector3d(0, 12, 100)).norm() < 1e-12;
        CHECK(found);
    }
    SECTION("under a mirror each corner keeps its colour") {
        // The first triangle has a colour at each corner; corners are told by their places, whatever their order.
        const std::string body =
            colours + object(R"(id="2")", 1, {R"(pid="1" p1="0" p2="1" p3="2")"}) +
            R"(<object id="3"><components><component objectid="2" transform="-2 0 0 0 3 0 0 0 1 10 0 0"/></components></object>)";
        const TexturedMesh plain = read3(body, R"(<item objectid="2"/>)").mesh,
                           mirrored = read3(body, R"(<item objectid="3"/>)").mesh;
        REQUIRE(mirrored.triangles.size() == 4);
        CHECK(volume_of(mirrored) == Approx(1));
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3d place = plain.positions[plain.triangles[0][c]],
                           moved(10 - 2 * place.x(), 3 * place.y(), place.z());
            std::size_t found = 0;
            for (std::size_t d = 0; d < 3; ++d) {
                if ((mirrored.positions[mirrored.triangles[0][d]] - moved).norm() > 1e-12) continue;
                ++found;
                CHECK(near(corner_colour(mirrored, 0, d), corner_colour(plain, 0, c)));
            }
            CHECK(found == 1);
        }
        CHECK_FALSE(near(corner_colour(plain, 0, 1), corner_colour(plain, 0, 2)));
    }
    SECTION("a colour that is itself transparent, under a transparent texture, lies over white") {
        // Red of which half is there over white is (1, 1/2, 1/2), and the texture hides nothing or all of it.
        const std::string resources =
            R"(<q:colorgroup id="1"><q:color color="#FF000080"/></q:colorgroup><q:texture2d id="3" path="/3D/t.png" contenttype="image/png"/>)"
            R"(<q:texture2dgroup id="4" texid="3"><q:tex2coord u="0.25" v="0.25"/></q:texture2dgroup>)"
            R"(<q:multiproperties id="5" pids="1 4"><q:multi pindices="0 0"/></q:multiproperties>)" +
            object(R"(id="2" pid="5" pindex="0")", 1);
        const auto seen = [&](std::uint8_t alpha) {
            std::vector<std::uint8_t> pixels;
            for (int n = 0; n < 4; ++n) pixels.insert(pixels.end(), {0, 0, 255, alpha});
            return corner_colour(read3(resources, R"(<item objectid="2"/>)", {{"3D/t.png", png(2, 2, pixels)}}).mesh, 0,
                                 0);
        };
        const float white = 1 - 128 / 255.0f;
        CHECK(near(seen(0), {1, white, white}, 5e-3f));
        CHECK(near(seen(255), {0, 0, 1}, 5e-3f));
        CHECK(near(seen(51), {0.8f, 0.8f * white, 0.8f * white + 0.2f}, 5e-3f));
    }
    SECTION("textures with tile styles") {
        const auto textured = [&](const std::string& style, const std::string& u) {
            return read3(R"(<q:texture2d id="1" path="/3D/T.png" contenttype="image/png" )" + style +
                             R"(/><q:texture2dgroup id="3" texid="1">)"
                             R"(<q:tex2coord u="0.25" v="0.25"/><q:tex2coord u=")" +
                             u + R"(" v="0.75"/></q:texture2dgroup>)" +
                             object(R"(id="2")", 1, {R"(pid="3" p1="0" p2="1" p3="0")"}),
                         R"(<item objectid="2"/>)", {{"3D/t.png", four_colours()}});
        };
        CHECK(near(corner_colour(textured("", "0.75").mesh, 0, 0), {0, 0, 1}));
        CHECK(near(corner_colour(textured("", "1.25").mesh, 0, 1), {1, 0, 0}));
        CHECK(near(corner_colour(textured(R"(tilestyleu="mirror")", "1.25").mesh, 0, 1), {0, 1, 0}));
        CHECK(near(corner_colour(textured(R"(tilestyleu="clamp")", "7").mesh, 0, 1), {0, 1, 0}));
        CHECK(near(corner_colour(textured(R"(tilestyleu="none")", "7").mesh, 0, 1), {1, 1, 1}));
        CHECK(near(corner_colour(textured("", "0.75").mesh, 1, 1), {1, 1, 1}));  // the other triangles have no colour
    }
    SECTION("a transparent texture over a colour; several layers are made into one picture") {
        const std::string resources =
            R"(<q:colorgroup id="1"><q:color color="#FF0000"/></q:colorgroup><q:texture2d id="3" path="/3D/t.png" contenttype="image/png"/>)"
            R"(<q:texture2dgroup id="4" texid="3"><q:tex2coord u="0.25" v="0.25"/></q:texture2dgroup>)"
            R"(<q:texture2dgroup id="6" texid="3"><q:tex2coord u="0.25" v="0.75"/></q:texture2dgroup>)";
        const Files picture{{"3D/t.png", png(2, 2, {0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 255, 51, 0, 0, 0, 255})}};
        const ModelFile file =
            read3(resources + R"(<q:multiproperties id="5" pids="1 4"><q:multi pindices="0 0"/></q:multiproperties>)" +
                      object(R"(id="2" pid="5" pindex="0")", 1),
                  R"(<item objectid="2"/>)", picture);
        CHECK(near(corner_colour(file.mesh, 0, 0), {0.8f, 0, 0.2f}, 5e-3f));
        const auto layers = [&](const std::string& attributes, const std::string& indices) {
            return read3(resources + "<q:multiproperties id=\"5\" " + attributes + "><q:multi pindices=\"" + indices +
                             "\"/></q:multiproperties>" + object(R"(id="2" pid="5" pindex="0")", 1),
                         R"(<item objectid="2"/>)", picture);
        };
        // Red, the blue fifth over it, and black over both; the other way round; red over the black; red times black.
        const std::vector<std::tuple<std::string, std::string, Vector3f>> cases{
            {R"(pids="1 4 6")", "0 0 0", {0, 0, 0}},
            {R"(pids="1 6 4")", "0 0 0", {0, 0, 0.2f}},
            {R"(pids="6 1")", "0 0", {1, 0, 0}},
            {R"(pids="1 6" blendmethods="multiply")", "0 0", {0, 0, 0}},
            {R"(pids="1 4" blendmethods="multiply")", "0 0", {0.8f, 0.8f, 0.8f}}};
        for (const auto& [attributes, indices, colour] : cases) {
            INFO(attributes);
            const ModelFile several = layers(attributes, indices);
            CHECK(several.lost_colour.empty());
            CHECK(several.has_colour);
            for (std::size_t t = 0; t < 4; ++t)
                for (std::size_t c = 0; c < 3; ++c) CHECK(near(corner_colour(several.mesh, t, c), colour, 6e-3f));
        }
    }
    SECTION("each layer of several has coordinates of its own") {
        const std::string resources =
            R"(<q:texture2d id="3" path="/3D/t.png" contenttype="image/png" tilestyleu="clamp" tilestylev="clamp"/>)"
            R"(<q:texture2d id="7" path="/3D/o.png" contenttype="image/png"/>)"
            R"(<q:texture2dgroup id="4" texid="3"><q:tex2coord u="0.25" v="0.25"/><q:tex2coord u="0.75" v="0.25"/><q:tex2coord u="0.25" v="0.75"/></q:texture2dgroup>)"
            R"(<q:texture2dgroup id="6" texid="7"><q:tex2coord u="0.1" v="0.9"/></q:texture2dgroup>)"
            R"(<q:multiproperties id="5" pids="4 6"><q:multi pindices="0 0"/><q:multi pindices="1 0"/><q:multi pindices="2 0"/></q:multiproperties>)";
        const ModelFile file =
            read3(resources + object(R"(id="2" pid="5" pindex="0")", 1, {R"(pid="5" p1="0" p2="1" p3="2")"}),
                  R"(<item objectid="2"/>)", {{"3D/t.png", four_colours()}, {"3D/o.png", png(1, 1, {0, 0, 0, 0})}});
        CHECK(near(corner_colour(file.mesh, 0, 0), {0, 0, 1}, 0.25f));
        CHECK(near(corner_colour(file.mesh, 0, 1), {1, 1, 1}, 0.25f));
        CHECK(near(corner_colour(file.mesh, 0, 2), {1, 0, 0}, 0.25f));
        CHECK(file.warnings.empty());
    }
    SECTION("parts in other files, supports, slicer paint, a missing texture") {
        const std::string other =
            R"(<model unit="millimeter"><resources>)" + object(R"(id="9")", 2) + "</resources><build/></model>";
        const ModelFile file =
            read3(R"(<object id="3"><components><component objectid="9" p:path="/3D/o.model"/></components></object>)" +
                      object(R"(id="4" type="support")", 1),
                  R"(<item objectid="3"/><item objectid="4"/>)", {{"3D/o.model", other}});
        CHECK(volume_of(file.mesh) == Approx(8 / 6.0));
        CHECK_THAT(warnings(file), Contains("support"));
        CHECK_THAT(
            warnings(read3(object(R"(id="2")", 1, {R"(slic3rpe:mmu_segmentation="4")"}), R"(<item objectid="2"/>)")),
            Contains("painted") && Contains("LOST"));
        CHECK_THAT(
            warnings(read3(
                R"(<q:texture2d id="1" path="/gone.png" contenttype="image/png"/><q:texture2dgroup id="3" texid="1">)"
                R"(<q:tex2coord u="0" v="0"/></q:texture2dgroup>)" +
                    object(R"(id="2" pid="3" pindex="0")", 1),
                R"(<item objectid="2"/>)")),
            Contains("gone.png") && Contains("LOST"));
    }
    SECTION("what cannot be gives a clear error") {
        const auto error = [&](const std::string& resources, const std::string& build = R"(<item objectid="2"/>)") {
            return refusal_by([&] { return read3(resources, build); });
        };
        CHECK_THAT(error(""), Contains("object 2"));
        CHECK_THAT(error(R"(<object id="2"><mesh><vertices/><triangles/></mesh></object>)"), Contains("no faces"));
        CHECK_THAT(
            error(
                R"(<object id="2"><mesh><vertices><vertex x="0" y="0" z="0"/></vertices><triangles><triangle v1="0" v2="0" v3="1"/></triangles></mesh></object>)"),
            Contains("vertex 1"));
        CHECK_THAT(error(R"(<object id="2"><mesh><vertices><vertex x="0" y="" z="0"/></vertices></mesh></object>)"),
                   Contains("no number"));
        CHECK_THAT(error(colours + object(R"(id="2" pid="1" pindex="3")", 1)), Contains("item 3"));
        CHECK_THAT(error(R"(<object id="2"><components><component objectid="2"/></components></object>)"),
                   Contains("hold themselves"));
        std::string tower = object(R"(id="1")", 1);  // 2^40 copies
        for (int i = 2; i <= 41; ++i)
            tower += fmt::format(
                R"(<object id="{0}"><components><component objectid="{1}"/><component objectid="{1}"/></components></object>)",
                i, i - 1);
        CHECK_THAT(error(tower, R"(<item objectid="41"/>)"), Contains("components"));
        CHECK_THAT(error("<a><b></a></b>"), Contains("closes nothing"));
        CHECK_THROWS_WITH(read(folder, {{"a.3mf", "PK no archive"}}), Contains("archive"));
        CHECK_THROWS_WITH(read(folder, {{"a.3mf", zip({{"x", "y"}})}}), Contains("3dmodel.model"));
        CHECK_THROWS_WITH(
            read(folder, {{"a.3mf", zip({{"3D/3dmodel.model", "<!DOCTYPE x [<!ENTITY a 'b'>]><model/>"}})}}),
            Contains("document type"));
        CHECK_THROWS_WITH(read(folder, {{"a.3mf", zip({{"3D/3dmodel.model", std::string(70 << 20, ' ')}})}}),
                          Contains("fill the memory"));
    }
}

TEST_CASE("What slicers write into 3MF files is heeded") {
    const Folder folder;
    const auto object = [](int id) {
        return fmt::format("<object id=\"{}\">{}</object>", id, threemf_tetrahedron(id, {}));
    };
    const auto read3 = [&](const std::string& resources, const std::string& build, const Files& others = {},
                           const std::string& attributes = "") {
        return read(folder, {{"a.3mf", threemf(resources, build, others, "millimeter", attributes)}});
    };
    const std::string both = R"(<item objectid="1"/><item objectid="2" printable="0"/>)";
    SECTION("items that are switched off") {
        const ModelFile one = read3(object(1) + object(2), both);
        CHECK(one.mesh.triangles.size() == 4);
        CHECK_THAT(warnings(one), Contains("switched off"));
        CHECK_THROWS_WITH(read3(object(2), R"(<item objectid="2" printable="0"/>)"), Contains("all 1 items"));
    }
    SECTION("roles of volumes and of parts") {
        const auto prusa = [&](const std::string& type) {
            return Files{
                {"Metadata/Slic3r_PE_model.config",
                 fmt::format(
                     R"(<config><object id="1"><volume firstid="0" lastid="1"><metadata key="volume_type" value="ModelPart"/></volume>)"
                     R"(<volume firstid="2" lastid="3"><metadata key="volume_type" value="{}"/></volume></object></config>)",
                     type)}};
        };
        const std::string item = R"(<item objectid="1"/>)";
        CHECK(read3(object(1), item, prusa("ModelPart")).mesh.triangles.size() == 4);
        for (const char* type : {"ParameterModifier", "SupportBlocker", "SupportEnforcer"}) {
            const ModelFile file = read3(object(1), item, prusa(type));
            CHECK(file.mesh.triangles.size() == 2);
            CHECK_THAT(warnings(file), Contains("modifiers or blockers"));
        }
        CHECK_THROWS_WITH(read3(object(1), item, prusa("NegativeVolume")),
                          Contains("negative volume") && Contains("not closed"));
        const auto bambu = [&](const std::string& type) {
            return read3(
                object(1) + object(2) +
                    R"(<object id="3"><components><component objectid="1"/><component objectid="2"/></components></object>)",
                R"(<item objectid="3"/>)",
                {{"Metadata/model_settings.config",
                  fmt::format(
                      R"(<config><object id="3"><part id="1" subtype="normal_part"/><part id="2" subtype="{}"/></object></config>)",
                      type)}});
        };
        CHECK(bambu("normal_part").mesh.triangles.size() == 8);
        CHECK(bambu("modifier_part").mesh.triangles.size() == 4);
        CHECK_THROWS_WITH(bambu("negative_part"), Contains("nothing is left"));  // each is cut out of the other
        // A file of another's own that is none: said, and all is printed.
        const ModelFile broken = read3(object(1), item, {{"Metadata/model_settings.config", "<config"}});
        CHECK(broken.mesh.triangles.size() == 4);
        CHECK_THAT(warnings(broken), Contains("could not be read"));
    }
    SECTION("colours of filaments tell parts apart") {
        const auto volumes = [](int second) {
            return fmt::format(
                R"(<config><object id="1"><volume firstid="0" lastid="1"><metadata key="extruder" value="1"/></volume>)"
                R"(<volume firstid="2" lastid="3"><metadata key="extruder" value="{}"/></volume></object></config>)",
                second);
        };
        const std::string item = R"(<item objectid="1"/>)";
        const ModelFile two = read3(object(1), item,
                                    {{"Metadata/Slic3r_PE_model.config", volumes(2)},
                                     {"Metadata/Slic3r_PE.config", "; filament_colour = #FF0000;#0000FF\n"}});
        CHECK(near(corner_colour(two.mesh, 0, 0), {1, 0, 0}));
        CHECK(near(corner_colour(two.mesh, 3, 0), {0, 0, 1}));
        CHECK(two.lost_colour.empty());
        CHECK_THAT(read3(object(1), item, {{"Metadata/Slic3r_PE_model.config", volumes(2)}}).lost_colour,
                   Contains("by extruder"));
        // One filament for all is no colour of the model's.
        CHECK_FALSE(read3(object(1), item,
                          {{"Metadata/Slic3r_PE_model.config", volumes(1)},
                           {"Metadata/project_settings.config", R"({"filament_colour": ["#FF0000", "#0000FF"]})"}})
                        .has_colour);
    }
    SECTION("an extension that is required and not known refuses the file; beams are lost") {
        CHECK_THROWS_WITH(read3(object(1), R"(<item objectid="1"/>)", {},
                                R"(requiredextensions="z" xmlns:z="http://example.com/booleans")"),
                          Contains("example.com/booleans"));
        const ModelFile beams =
            read3(fmt::format(
                      "<object id=\"1\">{}<beamlattice><beams><beam v1=\"0\" v2=\"1\"/></beams></beamlattice></object>",
                      threemf_tetrahedron(1, {})),
                  R"(<item objectid="1"/>)");
        CHECK_THAT(beams.lost_colour, Contains("beam lattice"));
    }
}

TEST_CASE("The files beside it that a model names are found out, there or not, whatever else is wrong with it") {
    const auto names = [](const Folder& folder, const Files& files) {
        std::string text;
        for (const SideFile& side : side_files_of(folder.write(files)))
            text += fmt::format("{}{} ", side.sha256.empty() ? "!" : "", side.name);
        return text;
    };
    const std::string obj = "mtllib a.mtl\n" + square + "usemtl m\nf 1/1 2/2 3/3 4/4\n";
    const Folder folder;
    CHECK(names(folder, {{"a.obj", obj}}) == "!a.mtl ");
    CHECK(names(folder, {{"a.obj", obj}, {"a.mtl", "newmtl m\nmap_Kd maps\\t.png\n"}}) == "a.mtl !maps\\t.png ");
    CHECK(names(folder, {{"a.obj", obj}, {"a.mtl", "newmtl m\nmap_Kd T.png\n"}, {"t.png", four_colours()}}) ==
          "a.mtl t.png ");
    // What is a file by another reading of the line is not missing.
    CHECK(names(folder, {{"d.obj", "mtllib a.mtl # of a\n" + square + "usemtl m\nf 1/1 2/2 3/3\n"}}) == "a.mtl t.png ");
    CHECK(names(folder, {{"e.obj", "mtllib a.mtl b.mtl\n" + square + "f 1/1 2/2 3/3\n"}}) == "a.mtl !b.mtl ");
    CHECK(names(folder, {{"b.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "gone.bin", "byteLength": 4}],
                         "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
                         "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                         "bufferViews": [{"buffer": 0, "byteLength": 36}], "scenes": [{"nodes": [0]}]})"}}) ==
          "!gone.bin ");
    CHECK(names(folder, {{"c.stl", "solid c\nendsolid c\n"}}).empty());
    CHECK_THROWS_AS(side_files_of(folder.path() / "gone.obj"), FileError);
    CHECK_THROWS_AS(side_files_of(folder.path() / "t.png"), InputError);
}
