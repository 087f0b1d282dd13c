// SPDX-License-Identifier: GPL-3.0-or-later
//
// Faults that files of real programs have: names that two libraries define, statements by other names, colours of
// another range, number or meaning than their format has.
#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "io/models/mtl_library.h"
#include "tests/io/models/model_test.h"

namespace {

const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.25\nvt 0.75 0.25\nvt 0.75 0.75\n";
const std::string face = "f 1/1 2/2 3/3\n";
const Vector3f red(1, 0, 0), blue(0, 0, 1), white(1, 1, 1);

ModelFile obj(const std::string& text, const Files& others) { return read_alone({{"a.obj", text}}, others); }

/// A GLB of one triangle, or of two over four vertices, with such colours.
struct Painted {
    std::string generator = "made", type = "VEC3", of_primitive{}, rest{};
    std::vector<float> colours{};
    bool two = false;

    [[nodiscard]] ModelFile read() const {
        std::vector<float> places{0, 0, 0, 1, 0, 0, 0, 1, 0};
        if (two) places.insert(places.end(), {1, 1, 0});
        const std::vector<std::uint16_t> index{0, 1, 2, 2, 1, 3};
        const std::size_t vertices = two ? 4 : 3, indices = two ? 6 : 3;
        std::string binary = raw(places);
        const std::size_t at_colours = binary.size();
        binary += raw(colours);
        const std::size_t at_index = binary.size();
        binary += raw(index).substr(0, 2 * indices);
        const std::size_t count = colours.size() / (type == "VEC3" ? 3 : 4);
        const std::string colour = colours.empty() ? "" : R"(,"COLOR_0":1)";
        const std::string json = fmt::format(
            R"({{"asset":{{"version":"2.0","generator":"{}"}},"buffers":[{{"byteLength":{}}}],"bufferViews":[)"
            R"({{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}},)"
            R"({{"buffer":0,"byteOffset":{},"byteLength":{}}}],"accessors":[)"
            R"({{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},)"
            R"({{"bufferView":1,"componentType":5126,"count":{},"type":"{}"}},)"
            R"({{"bufferView":2,"componentType":5123,"count":{},"type":"SCALAR"}}],)"
            R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{}}},"indices":2{}}}]}}]{}}})",
            generator, binary.size(), at_colours, at_colours, std::max<std::size_t>(4 * colours.size(), 4), at_index,
            2 * indices, vertices, count, type, indices, colour, of_primitive, rest);
        return read_alone({{"a.glb", glb(json, binary)}, {"t.png", four_colours()}});
    }
};

}  // namespace

TEST_CASE("A material is of the library that was named last before its use") {
    const Files both{{"x.mtl", "newmtl m\nKd 1 0 0\n"}, {"y.mtl", "newmtl m\nKd 0 0 1\nnewmtl n\nKd 0 1 0\n"}};
    const std::string use = "usemtl m\n" + face;
    const auto colours = [&](const std::string& text) {
        const ModelFile file = obj(text, both);
        std::vector<Vector3f> all;
        for (std::size_t t = 0; t < file.mesh.triangles.size(); ++t) all.push_back(corner_colour(file.mesh, t, 0));
        CHECK_THAT(warnings(file), Contains("Several libraries of a.obj have the material 'm', and not alike"));
        return all;
    };
    using All = std::vector<Vector3f>;
    CHECK(colours(corners + "mtllib x.mtl\n" + use + "mtllib y.mtl\n" + use) == All{red, blue});
    CHECK(colours("mtllib x.mtl\nmtllib y.mtl\n" + corners + use) == All{blue});
    CHECK(colours("mtllib x.mtl\n" + corners + use + "mtllib y.mtl\n" + use + "mtllib x.mtl\n" + use) ==
          All{red, blue, red});
    CHECK(colours(corners + use + "mtllib x.mtl\nmtllib y.mtl\n") == All{red});  // none before it: the first behind
    CHECK(colours("mtllib x.mtl y.mtl\n" + corners + use) == All{red});          // of a line the first
    // What the last does not have an earlier one may; alike in both, nothing is said; the same one again is one
    // material.
    const ModelFile earlier = obj("mtllib y.mtl\nmtllib z.mtl\n" + corners + "usemtl n\n" + face,
                                  {both[1], {"z.mtl", "newmtl m\nKd 0 0 1\n"}});
    CHECK(near(corner_colour(earlier.mesh, 0, 0), {0, 1, 0}));
    CHECK(earlier.warnings.empty());
    const std::string again = "mtllib x.mtl\nmtllib z.mtl\n" + use;
    const ModelFile alike = obj(corners + again + again, {both[0], {"z.mtl", "newmtl m\nKd 1 0 0\nNs 5\n"}});
    CHECK(alike.warnings.empty());
    CHECK(alike.mesh.materials.size() == 1);
}

TEST_CASE("A picture by an unknown name is lost colour where there is one and no map_Kd") {
    const auto with = [&](const std::string& material) {
        return obj("mtllib a.mtl\n" + corners + "usemtl m\n" + face,
                   {{"a.mtl", "newmtl m\n" + material}, {"t.png", four_colours()}});
    };
    for (const std::string name : {"map_albedo", "map_baseColor", "map_diffuse", "MAP_Color", "map_Kc"}) {
        CAPTURE(name);
        const ModelFile file = with("Kd 1 1 1\n" + name + " t.png\n");
        CHECK_THAT(file.lost_colour, Contains("'t.png'") && Contains(name) && Contains("Call it map_Kd"));
        CHECK(with("Kd 1 1 1\n" + name + " gone.png\n").lost_colour.empty());
        CHECK(with("map_Kd t.png\n" + name + " t.png\n").lost_colour.empty());
    }
    for (const std::string name : {"map_Bump", "map_Ks", "map_Ns", "map_Pr", "map_Pm", "map_normal", "map_roughness",
                                   "map_occlusion", "map_refl", "map_d", "bump", "norm", "disp"})
        CHECK(with("Kd 1 0 0\n" + name + " t.png\n").lost_colour.empty());
}

TEST_CASE("An opacity map is left aside, and told of with what is printed in its place") {
    const ModelFile file = obj("mtllib a.mtl\n" + corners + "usemtl m\n" + face,
                               {{"a.mtl", "newmtl m\nmap_Kd t.png\nmap_d t.png\n"}, {"t.png", four_colours()}});
    CHECK_THAT(warnings(file), Contains("'m' has an opacity map") && Contains("the alpha of its map_Kd") &&
                                   Contains("--alpha translucency") && Contains("[transparent]"));
    CHECK(file.lost_colour.empty());
}

TEST_CASE("The range that a material gives its picture") {
    const auto with = [&](const std::string& map, bool deep = false) {
        return corner_colour(obj("mtllib a.mtl\n" + corners + "usemtl m\n" + face,
                                 {{"a.mtl", "newmtl m\n" + map + "\nnewmtl n\nmap_Kd t.png\n"},
                                  {"t.png", png(1, 1, {200, 100, 0, 255}, deep)}})
                                 .mesh,
                             0, 0);
    };
    const auto code = [](double r, double g, double b) { return Vector3f(linear(r), linear(g), linear(b)); };
    for (const bool deep : {false, true}) {
        CHECK(near(with("map_Kd -mm 0 1 t.png", deep), code(200 / 255.0, 100 / 255.0, 0)));
        CHECK(near(with("map_Kd -mm 0 0.5 t.png", deep), code(100 / 255.0, 50 / 255.0, 0)));
        CHECK(near(with("map_Kd -mm 0.2 2 t.png", deep), code(1, 0.2 + 200 / 255.0, 0.2), 4e-3f));
        CHECK(near(with("map_Kd -mm 1 -1 t.png", deep), code(55 / 255.0, 155 / 255.0, 1)));
    }
    CHECK(near(with("Kd 0.8 0.8 0.8\nmap_Ka -mm 0 0.5 t.png"), code(100 / 255.0, 50 / 255.0, 0)));
    // Options are those of the last statement, also where it stands for another.
    const auto materials =
        parse_mtl("newmtl a\nmap_Kd -s 2 2 -mm 1 0 x.png\nmap_Kd y.png\nnewmtl b\nmap_Ka -o 0.5 0 -mm 0.1 z.png\n");
    REQUIRE(materials.size() == 2);
    CHECK(materials[0].map_kd == "y.png");
    CHECK(materials[0].map_scale == Eigen::Vector2f(1, 1));
    CHECK(materials[0].map_gain == 1);
    CHECK(materials[1].map_kd == "z.png");
    CHECK(materials[1].map_offset == Eigen::Vector2f(0.5f, 0));
    CHECK(materials[1].map_base == 0.1f);
}

TEST_CASE("A material whose only colour is white has none") {
    const auto with = [&](const std::string& mtl) {
        return obj("mtllib a.mtl\n" + corners + "usemtl m\n" + face, {{"a.mtl", mtl}, {"t.png", four_colours()}});
    };
    CHECK_FALSE(with("newmtl m\nKd 1 1 1\n").has_colour);
    CHECK_FALSE(with("newmtl m\nKd 255 255 255\n").has_colour);
    CHECK(with("newmtl m\nKd 1 1 0.99\n").has_colour);
    CHECK(with("newmtl m\nKd 1 1 1\nmap_Kd t.png\n").has_colour);
}

TEST_CASE("Floats of glTF go by the rule of all formats, and stay linear") {
    const auto with = [](const std::vector<float>& colours, const std::string& type = "VEC3") {
        return Painted{.type = type, .colours = colours}.read();
    };
    const ModelFile bytes = with({255, 51, 0, 0, 255, 0, 0, 0, 127.5f});
    CHECK(near(corner_colour(bytes.mesh, 0, 0), {1, 0.2f, 0}));
    CHECK(near(corner_colour(bytes.mesh, 0, 2), {0, 0, 0.5f}));
    CHECK_THAT(warnings(bytes), Contains("go up to 255: they were taken as of 0 to 255") && Contains("[colour-range]"));
    CHECK(bytes.lost_colour.empty());
    CHECK(near(corner_colour(with({65535, 0, 0, 0, 0, 0, 0, 0, 0}).mesh, 0, 0), {1, 0, 0}));
    CHECK(near(corner_colour(with({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255}, "VEC4").mesh, 0, 0), {1, 0, 0}));
    CHECK(near(corner_colour(with({255, 0, 0, 1, 0, 255, 0, 1, 0, 0, 255, 1}, "VEC4").mesh, 0, 1), {0, 1, 0}));
    CHECK(with({1, 0, 0, 0.5f, 1, 0, 0, 0, 1}).warnings.empty());
    const ModelFile bright = with({1.7f, 0.2f, 0, 0.5f, 1, 0, 0, 0, 1});
    CHECK(near(corner_colour(bright.mesh, 0, 0), {1, 0.2f, 0}));
    CHECK(bright.lost_colour.empty());
    // Too bright throughout, in glTF, OBJ and PLY: all are clamped to one.
    const auto lost = Contains("clamping makes all of them one: they are LOST");
    CHECK_THAT(with({2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f, 1.5f, 2.5f, 3.5f}).lost_colour, lost);
    CHECK_THAT(obj("v 0 0 0 2.5 3.5 4.5\nv 1 0 0 5.5 6.5 7.5\nv 0 1 0 1.5 1.25 3.5\nf 1 2 3\n", {}).lost_colour, lost);
    CHECK_THAT(obj("v 0 0 0 -1 -2 -3\nv 1 0 0 -4 -5 -6\nv 0 1 0 -1 0 0\nf 1 2 3\n", {}).lost_colour, lost);
    CHECK(obj("v 0 0 0 2.5 2.5 2.5\nv 1 0 0 2.5 2.5 2.5\nv 0 1 0 2.5 2.5 2.5\nf 1 2 3\n", {}).lost_colour.empty());
}

TEST_CASE("As many colours as faces are the faces', any other number is lost") {
    const std::vector<float> two{1, 0, 0, 0, 0, 1}, five{1, 0, 0, 0, 0, 1, 1, 1, 0, 0, 1, 0, 1, 1, 1},
        four{1, 0, 0, 0, 0, 1, 1, 1, 0, 0, 1, 0};
    const ModelFile faces = Painted{.colours = two, .two = true}.read();
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(near(corner_colour(faces.mesh, 0, c), red));
        CHECK(near(corner_colour(faces.mesh, 1, c), blue));
    }
    CHECK_THAT(warnings(faces), Contains("2 colours for 4 vertices") && Contains("[which-colour]"));
    CHECK(faces.lost_colour.empty());
    const ModelFile damaged = Painted{.colours = five, .two = true}.read();
    CHECK_THAT(damaged.lost_colour, Contains("5 colours for 4 vertices"));
    CHECK(near(corner_colour(damaged.mesh, 0, 0), white));
    CHECK(damaged.has_colour);
    CHECK(Painted{.colours = four, .two = true}.read().warnings.empty());
}

TEST_CASE("A primitive without a material is opaque") {
    const std::vector<float> half{0.25f, 0.25f, 0.25f, 0.5f, 0.25f, 0.25f, 0.25f, 0.5f, 0.25f, 0.25f, 0.25f, 0.5f};
    const ModelFile bare = Painted{.type = "VEC4", .colours = half}.read();
    CHECK(near(corner_colour(bare.mesh, 0, 0), Vector3f::Constant(0.25f)));
    CHECK(bare.warnings.empty());
    const Painted blend{.type = "VEC4",
                        .of_primitive = R"(,"material":0)",
                        .rest = R"(,"materials":[{"alphaMode":"BLEND"}])",
                        .colours = half};
    CHECK(near(corner_colour(blend.read().mesh, 0, 0), Vector3f::Constant(0.625f)));
}

TEST_CASE("Programs that write colours in a way of their own are named") {
    const std::vector<float> colours{0.2f, 0.4f, 0.6f, 0.2f, 0.4f, 0.6f, 0.2f, 0.4f, 0.6f};
    const auto said = [&](const std::string& generator, const std::vector<float>& of, const std::string& factor = "") {
        Painted model{.generator = generator, .colours = of};
        if (!factor.empty()) {
            model.of_primitive = R"(,"material":0)";
            model.rest = R"(,"materials":[{"pbrMetallicRoughness":{"baseColorFactor":)" + factor + "}}]";
        }
        return warnings(model.read());
    };
    const auto mixed = Contains("written by Blender 3.4, which mixes up colours");
    CHECK_THAT(said("Khronos glTF Blender I/O v3.4.50", colours), mixed);
    CHECK(said("Khronos glTF Blender I/O v3.4.50", {}, "[0.5,0.5,0.5,1]").empty());
    CHECK(said("Khronos glTF Blender I/O v4.2.60", colours).empty());
    const auto codes = Contains("puts sRGB codes where glTF has linear light");
    CHECK_THAT(said("VTK", colours), codes && Contains("as PLY"));
    CHECK_THAT(said("VTK", {}, "[0.5,0.5,0.5,1]"), codes);
    CHECK_THAT(said("obj2gltf", {}, "[0.5,0.5,0.5,1]"), codes && Contains("the OBJ itself"));
    CHECK(said("obj2gltf", {}, "[1,0,0,1]").empty());  // 0 and 1 are what they are
    CHECK(said("three.js", colours, "[0.5,0.5,0.5,1]").empty());
}

TEST_CASE("What has a picture and no place for it is said once, in words that are so") {
    const std::string picture = R"(,"images":[{"uri":"t.png"}],"textures":[{"source":0}],)";
    const std::string textured = picture +
                                 R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1},)"
                                 R"("baseColorFactor":[0,0,1,1]}}])";
    const ModelFile missing = Painted{.of_primitive = R"(,"material":0)", .rest = textured}.read();
    CHECK_THAT(missing.lost_colour,
               Contains("no coordinates TEXCOORD_1") && Contains("the material's own colour is used"));
    CHECK_THAT(missing.lost_colour, !Contains("no texture coordinates"));
    CHECK(near(corner_colour(missing.mesh, 0, 0), blue));
    // A material of nobody's has no surface that could lack coordinates.
    const ModelFile unused = Painted{.rest = textured}.read();
    CHECK(unused.lost_colour.empty());
    const Painted variants{
        .of_primitive = R"(,"extensions":{"KHR_materials_variants":{"mappings":[{"material":0,"variants":[0]}]}})",
        .rest = textured + R"(,"extensions":{"KHR_materials_variants":{"variants":[{"name":"oak"},{"name":"ash"}]}})"};
    CHECK_THAT(variants.read().lost_colour, Contains("those of variants ('oak', 'ash')"));
}

TEST_CASE("A PLY of assimp that is no PLY says how to write one") {
    const auto text = [](const std::string& format) {
        return "ply\nformat " + format +
               " 1.0\ncomment Created by Open Asset Import Library - http://assimp.sf.net (v5.2.0)\nelement vertex 3\n"
               "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
               "property uchar blue\nproperty uchar alpha\nelement face 1\nproperty list uchar int vertex_index\n"
               "end_header\n";
    };
    const std::string vertex = raw<float>({0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 0.5f, 1});
    const auto refusal = [](const std::string& bytes) {
        return refusal_by([&] { return read_alone({{"a.ply", bytes}}); });
    };
    std::string body;
    for (int i = 0; i < 3; ++i) body += vertex;
    body += std::string("\3", 1) + raw<std::int32_t>({0, 1, 2});
    CHECK_THAT(refusal(text("binary_little_endian") + body), Contains("written by assimp") && Contains("text PLY"));
    CHECK(refusal(text("ascii") + "0 0 0 1 2 3 4\n1 0 0 1 2 3 4\n0 1 0 1 2 3 4\n3 0 1 2\n") == "no error");
}
