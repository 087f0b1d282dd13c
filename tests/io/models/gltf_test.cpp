// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/files/base64.h"
#include "io/pictures/texture.h"
#include "optics/colour/colour.h"
#include "tests/io/models/compressed_samples.h"
#include "tests/io/models/model_test.h"

namespace {

struct Builder : GltfBuilder {
    int floats(const std::vector<float>& values, const std::string& type) {
        return data(raw(values), 5126, values.size() / (type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4), type);
    }
};

std::string base64_of(const std::string& bytes) {
    return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

const std::vector<float> triangle{0, 0, 0, 1, 0, 0, 0, 1, 0};

ModelFile read(const std::string& bytes, const Files& others = {}) { return read_alone({{"a.glb", bytes}}, others); }

std::string error_of(const std::string& bytes) {
    return refusal_by([&] { return read(bytes); });
}

}  // namespace

TEST_CASE("glTF models") {
    SECTION("nodes: tree, matrix and TRS, y up to z up, a mirror turns the triangles") {
        Builder b;
        const int p = b.floats(triangle, "VEC3");
        const ModelFile file = read(b.file(fmt::format(
            R"("scene":0,"scenes":[{{"nodes":[0,2]}}],"nodes":[{{"children":[1],"translation":[0,10,0]}},)"
            R"({{"mesh":0,"rotation":[0,0,0.70710678,0.70710678],"scale":[2,1,1]}},{{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,7,1]}}],)"
            R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])",
            p)));
        CHECK(file.format == "glTF");
        CHECK(file.mm_per_file_unit == 1000);
        CHECK_FALSE(file.has_colour);
        REQUIRE(file.mesh.triangles.size() == 2);
        const auto at = [&](std::size_t t, std::size_t c) { return file.mesh.positions[file.mesh.triangles[t][c]]; };
        // (1, 0, 0): scaled to (2, 0, 0), turned about z to (0, 2, 0), moved to (0, 12, 0), then z up: (0, 0, 12)
        CHECK((at(0, 1) - Vector3d(0, 0, 12)).norm() < 1e-6);
        CHECK((at(0, 2) - Vector3d(-1, 0, 10)).norm() < 1e-6);
        // mirrored: corners 1 and 2 change places; z = 7 becomes y = -7
        CHECK((at(1, 1) - Vector3d(0, -7, 1)).norm() < 1e-6);
        CHECK((at(1, 2) - Vector3d(-1, -7, 0)).norm() < 1e-6);
    }
    SECTION("normalised integers are shares of their largest, and -1 is the least") {
        // As meshes are quantised: x of the largest and the least, y, and half of z. Then z up: (x, -z, y).
        const auto positions = [&](const std::string& bytes, int type) {
            Builder b;
            const int p = b.data(bytes, type, 4, "VEC3", R"(,"normalized":true)");
            return read(b.file(fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":)"
                                           R"({{"POSITION":{}}},"mode":5}}]}}])",
                                           p)))
                .mesh.positions;
        };
        using S = std::int16_t;
        using B = std::int8_t;
        const auto shorts =
            positions(raw(std::vector<S>{32767, 0, 0, -32767, 0, 0, 0, 32767, 0, -32768, 0, 16384}), 5122);
        REQUIRE(shorts.size() == 4);
        CHECK(shorts[0] == Vector3d(1, 0, 0));
        CHECK(shorts[1] == Vector3d(-1, 0, 0));
        CHECK(shorts[2] == Vector3d(0, 0, 1));
        CHECK(shorts[3].x() == -1);
        CHECK(shorts[3].y() == Approx(-16384.0 / 32767).epsilon(1e-7));
        const auto bytes = positions(raw(std::vector<B>{127, 0, 0, -127, 0, 0, 0, 127, 0, -128, 0, 64}), 5120);
        REQUIRE(bytes.size() == 4);
        CHECK(bytes[0] == Vector3d(1, 0, 0));
        CHECK(bytes[1] == Vector3d(-1, 0, 0));
        CHECK(bytes[3].x() == -1);
        CHECK(bytes[3].y() == Approx(-64.0 / 127).epsilon(1e-7));
        using U = std::uint16_t;
        const auto unsigned_shorts =
            positions(raw(std::vector<U>{65535, 0, 0, 0, 0, 0, 0, 65535, 0, 13107, 0, 65535}), 5123);
        REQUIRE(unsigned_shorts.size() == 4);
        CHECK(unsigned_shorts[0] == Vector3d(1, 0, 0));
        CHECK(unsigned_shorts[3].x() == Approx(0.2).epsilon(1e-7));
        CHECK(unsigned_shorts[3].y() == -1);
    }
    SECTION("strips, fans, points, interleaved and sparse data") {
        Builder b;
        const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
        const auto primitive = [&](int mode, int position) {
            return fmt::format(R"({{"attributes":{{"POSITION":{}}},"mode":{}}})", position, mode);
        };
        const std::string nodes = R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[)";
        const ModelFile strip = read(b.file(nodes + primitive(5, p) + "," + primitive(0, p) + "]}]"));
        REQUIRE(strip.mesh.triangles.size() == 2);
        for (std::size_t t = 0; t < 2; ++t) {
            const auto& c = strip.mesh.triangles[t];
            const Vector3d &x = strip.mesh.positions[c[0]], &y = strip.mesh.positions[c[1]],
                           &z = strip.mesh.positions[c[2]];
            CHECK((y - x).cross(z - x).y() < 0);  // both face the same way: +z in the file, -y here
        }
        CHECK_THAT(warnings(strip), Contains("points"));
        CHECK(read(b.file(nodes + primitive(6, p) + "]}]")).mesh.triangles.size() == 2);
        CHECK_THAT(error_of(b.file(nodes + primitive(1, p) + "]}]")), Contains("no faces"));

        Builder s;
        const int zeros_and = s.data(
            raw(triangle), 5126, 3, "VEC3",
            R"(,"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}})");
        s.data(std::string("\2", 1), 5121, 1, "SCALAR");
        s.floats({5, 6, 7}, "VEC3");
        const ModelFile sparse = read(s.file(nodes + primitive(4, zeros_and) + "]}]"));
        CHECK((sparse.mesh.positions[2] - Vector3d(5, -7, 6)).norm() < 1e-6);
    }
    SECTION("colour = factor * vertex colour * texture; v runs down in the file") {
        Builder b;
        const int p = b.floats(triangle, "VEC3"), uv = b.floats({0.25f, 0.25f, 0.75f, 0.25f, 0.25f, 0.75f}, "VEC2");
        const int rgb =
            b.data(raw(std::vector<std::uint16_t>{65535, 65535, 65535, 32768, 0, 65535, 0, 65535, 65535, 0, 0, 0}),
                   5123, 3, "VEC4", R"(,"normalized":true)");
        const ModelFile file = read(
            b.file(fmt::format(
                R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"TEXCOORD_1":{},"COLOR_0":{}}},"material":0}}]}}],)"
                R"("materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.5,1,0.1],"baseColorTexture":{{"index":0,"texCoord":1}}}}}}],)"
                R"("textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071,"wrapT":33648,"magFilter":9728}}],"images":[{{"uri":"t%20.png"}}])",
                p, uv, rgb)),
            {{"t .png", four_colours()}});
        CHECK(file.has_colour);
        CHECK(file.warnings.empty());  // OPAQUE: alpha is not looked at
        const SurfaceMaterial& material = file.mesh.materials[file.mesh.material_of_triangle[0]];
        CHECK(material.texture->nearest());
        CHECK(near(material.rgb, {0.5f, 0.5f, 1}));
        REQUIRE(material.texture);
        CHECK(material.texture->wrap_u() == Wrap::clamp);
        CHECK(material.texture->wrap_v() == Wrap::mirror);
        const auto texel = [&](std::size_t c) {
            return material.texture->sample(file.mesh.corner_uv[0][c].x(), file.mesh.corner_uv[0][c].y());
        };
        CHECK(near(texel(0), {1, 0, 0}));
        CHECK(near(texel(1), {0, 1, 0}));
        CHECK(near(texel(2), {0, 0, 1}));
        CHECK(near(file.mesh.corner_rgb[0][1], {0, 1, 0}, 1e-6f));
        CHECK(near(file.mesh.corner_rgb[0][0], {1, 1, 1}, 1e-6f));
    }
    SECTION("texture transform: scale, then counter-clockwise rotation, then offset") {
        Builder b;
        const int p = b.floats(triangle, "VEC3"), uv = b.floats({0, 0, 0.5f, 0, 0, 0.25f}, "VEC2");
        const ModelFile file = read(
            b.file(fmt::format(
                R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"TEXCOORD_0":{}}},"material":0}}]}}],)"
                R"("materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,"extensions":{{"KHR_texture_transform":)"
                R"({{"offset":[0.1,0.9],"rotation":1.57079633,"scale":[1,2]}}}}}}}}}}],"textures":[{{"source":0}}],"images":[{{"uri":"t.png"}}])",
                p, uv)),
            {{"t.png", four_colours()}});
        // In the file's axes, v down: (0.5, 0) turns counter-clockwise on the picture, that is up: (0, -0.5).
        const auto uv_of = [&](std::size_t c) {
            return Vector2f(file.mesh.corner_uv[0][c].x(), 1 - file.mesh.corner_uv[0][c].y());
        };
        CHECK((uv_of(0) - Vector2f(0.1f, 0.9f)).norm() < 1e-5f);
        CHECK((uv_of(1) - Vector2f(0.1f, 0.4f)).norm() < 1e-5f);
        CHECK((uv_of(2) - Vector2f(0.6f, 0.9f)).norm() < 1e-5f);
    }
    SECTION("alpha counts where the material says so") {
        Builder b;
        const int p = b.floats(triangle, "VEC3");
        const auto with = [&](const std::string& mode) {
            return read(b.file(fmt::format(
                R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"material":0}}]}}],)"
                R"("materials":[{{{}"pbrMetallicRoughness":{{"baseColorFactor":[1,0,0,0.25]}}}}])",
                p, mode)));
        };
        CHECK(near(with("").mesh.materials[0].rgb, {1, 0, 0}));
        const ModelFile blend = with(R"("alphaMode":"BLEND",)");
        CHECK(near(blend.mesh.materials[0].rgb, {1, 0.75f, 0.75f}));
        CHECK_THAT(warnings(blend), Contains("over white"));
    }
    SECTION("what cannot be gives a clear error") {
        Builder b;
        const int p = b.floats(triangle, "VEC3"),
                  far = b.data(raw(std::vector<std::uint16_t>{0, 1, 3}), 5123, 3, "SCALAR");
        const int bomb = b.data(std::string(12, '\0'), 5126, 2000000000, "VEC3");
        const int nan = b.floats({0, 0, 0, NAN, 0, 0, 0, INFINITY, 0}, "VEC3");
        const auto mesh = [&](const std::string& primitive) {
            return b.file(R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[)" + primitive + "]}]");
        };
        const auto position = [](int accessor) {
            return fmt::format(R"({{"attributes":{{"POSITION":{}}}}})", accessor);
        };
        CHECK_THAT(error_of(mesh(fmt::format(R"({{"attributes":{{"POSITION":{}}},"indices":{}}})", p, far))),
                   Contains("vertex 3"));
        CHECK_THAT(error_of(mesh(position(bomb))), Contains("2000000000"));
        CHECK_THAT(error_of(mesh(position(nan))), Contains("infinite or not numbers"));
        CHECK_THAT(error_of(mesh(position(99))), Contains("accessor 99"));
        CHECK_THAT(error_of(mesh(R"({"attributes":{"POSITION":-2}})")), Contains("accessor -2"));
        CHECK_THAT(error_of(mesh(R"({"attributes":{"POSITION":"0"}})")), Contains("accessor"));
        CHECK_THAT(error_of(b.file(R"("nodes":[{"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}])")),
                   Contains("two parents"));
        CHECK_THAT(error_of(b.file(R"("extensionsRequired":["XY_mesh_compression"])")),
                   Contains("XY_mesh_compression"));
        CHECK_THAT(error_of(glb(R"({"asset":{"version":"1.0"}})", "")), Contains("version"));
        CHECK_THAT(error_of(glb(R"({"asset":)", "")), Contains("JSON"));
        std::string binary_first = glb(R"({"asset":{"version":"2.0"}})", "");
        binary_first.replace(16, 4, "BIN\0", 4);
        CHECK_THAT(error_of(binary_first), Contains("first chunk is of the type 'BIN") && Contains("not JSON"));
        CHECK_THAT(error_of(glb(R"([1])", "")), Contains("version"));
        CHECK_THAT(error_of(glb(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":5,"uri":"../x.bin"}]})", "")),
                   Contains("../x.bin"));
        CHECK_THAT(error_of(glb(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":99}]})", "1234")),
                   Contains("cut short"));
        CHECK_THAT(error_of(glb(std::string(100000, '['), "")), Contains("JSON"));
    }
}

TEST_CASE("glTF in the pose of the file, with its copies, and without what it hides") {
    Builder b;
    const int p = b.floats(triangle, "VEC3");
    const auto at = [](const ModelFile& file, std::size_t t, std::size_t c) {
        return file.mesh.positions[file.mesh.triangles[t][c]];
    };
    SECTION("a skin moves its mesh by its joints, and not by the node") {
        const int joints = b.data(std::string(12, '\0'), 5121, 3, "VEC4"),
                  weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
        // Inverse bind: ten times as small. The joint stands at (0, 5, 0), turned by 90 degrees about z.
        const int bind =
            b.data(raw(std::vector<float>{0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 1}), 5126, 1, "MAT4");
        const ModelFile file = read(b.file(fmt::format(
            R"("scene":0,"scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0,"skin":0,"translation":[100,0,0],"scale":[7,7,7]}},)"
            R"({{"translation":[0,5,0],"rotation":[0,0,0.70710678,0.70710678]}}],"skins":[{{"joints":[1],"inverseBindMatrices":{}}}],)"
            R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"JOINTS_0":{},"WEIGHTS_0":{}}}}}]}}])",
            bind, p, joints, weights)));
        REQUIRE(file.mesh.triangles.size() == 1);
        CHECK((at(file, 0, 0) - Vector3d(0, 0, 5)).norm() < 1e-6);
        CHECK((at(file, 0, 1) - Vector3d(0, 0, 5.1)).norm() < 1e-6);
        CHECK((at(file, 0, 2) - Vector3d(-0.1, 0, 5)).norm() < 1e-6);
    }
    SECTION("morph weights of the node come before those of the mesh") {
        const int by = b.floats({0, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3");
        const auto with = [&](const std::string& node) {
            return read(b.file(fmt::format(
                R"("nodes":[{{"mesh":0{}}}],"meshes":[{{"weights":[0.5],"primitives":[{{"attributes":{{"POSITION":{}}},"targets":[{{"POSITION":{}}}]}}]}}])",
                node, p, by)));
        };
        CHECK(at(with(""), 0, 1).x() == Approx(2));
        CHECK(at(with(R"(,"weights":[1])"), 0, 1).x() == Approx(3));
    }
    SECTION("copies, hidden nodes, and extensions that are not known") {
        const int moved = b.floats({0, 0, 0, 10, 0, 0, 20, 0, 0}, "VEC3");
        const std::string mesh = fmt::format(R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])", p);
        const ModelFile copies = read(b.file(fmt::format(
            R"("extensionsRequired":["EXT_mesh_gpu_instancing"],"nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{}}}}}}}}}],{})",
            moved, mesh)));
        REQUIRE(copies.mesh.triangles.size() == 3);
        CHECK(at(copies, 2, 0).x() == Approx(20));
        const ModelFile hidden = read(b.file(
            R"("extensionsRequired":["KHR_node_visibility"],"nodes":[{"mesh":0},{"mesh":0,"extensions":{"KHR_node_visibility":{"visible":false}}}],)" +
            mesh));
        CHECK(hidden.mesh.triangles.size() == 1);
        CHECK_THAT(warnings(hidden), Contains("1 hidden nodes"));
        CHECK_THAT(error_of(b.file(R"("extensionsRequired":["XY_unheard"],"nodes":[{"mesh":0}],)" + mesh)),
                   Contains("XY_unheard") && !Contains("compression"));
        CHECK_THAT(error_of(b.file(R"("extensionsRequired":["XY_mesh_compression"],"nodes":[{"mesh":0}],)" + mesh)),
                   Contains("without mesh compression"));
    }
    SECTION(
        "MASK is opaque from its cutoff on; glow is the colour of what is black; the older workflow where it is the "
        "material") {
        const auto colour = [&](const std::string& material) {
            const ModelFile file = read(b.file(fmt::format(
                R"("nodes":[{{"mesh":0}}],"materials":[{}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"material":0}}]}}])",
                material, p)));
            return file.mesh.materials[0].rgb;
        };
        CHECK(near(colour(R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[0.5,0,0,0.63]}})"),
                   {0.5f, 0, 0}));
        CHECK(near(colour(R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0,0,0,0.5]}})"),
                   {0.5f, 0.5f, 0.5f}));
        CHECK(near(colour(R"({"emissiveFactor":[0,1,0],"pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]}})"),
                   {0, 1, 0}));
        CHECK(near(colour(R"({"emissiveFactor":[0,1,0],"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}})"),
                   {1, 0, 0}));
        CHECK(near(
            colour(
                R"({"pbrMetallicRoughness":{},"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0,0,1,1]}}})"),
            {0, 0, 1}));
    }
}

TEST_CASE("Glass is lost, by the name of the materials that the body has") {
    Builder b;
    const int p = b.floats(triangle, "VEC3");
    const auto lost = [&](const std::string& extensions, int used = 0) {
        return read(
                   b.file(fmt::format(
                       R"("nodes":[{{"mesh":0}}],"materials":[{{"name":"jelly","extensions":{{{}}}}},{{"name":"skin"}}],)"
                       R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"material":{}}}]}}])",
                       extensions, p, used)))
            .lost_colour;
    };
    CHECK_THAT(
        lost(R"("KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume":{"thicknessFactor":1})"),
        Contains("'jelly'") && Contains("LOST"));
    CHECK_THAT(lost(R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.5})"), Contains("'jelly'"));
    CHECK(lost(R"("KHR_materials_transmission":{"transmissionFactor":1})", 1).empty());
    CHECK(lost(R"("KHR_materials_transmission":{"transmissionFactor":0},"KHR_materials_volume":{"thicknessFactor":1})")
              .empty());
    CHECK(lost(R"("KHR_materials_ior":{"ior":1.4})").empty());
}

TEST_CASE("glTF as the world writes it") {
    Builder b;
    const int p = b.floats(triangle, "VEC3");
    const auto mesh = [](const std::string& attributes, const std::string& rest = "", const std::string& of_it = "") {
        return fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{{}}}{}}}]}}]{})",
                           attributes, of_it, rest);
    };
    const std::string position = fmt::format(R"("POSITION":{})", p);
    SECTION("colours of vertices of every type, whether they are said to be normalised or not") {
        const auto colour = [&](int accessor) {
            return read(b.file(mesh(position + fmt::format(R"(,"COLOR_0":{})", accessor)))).mesh.corner_rgb[0][1];
        };
        for (const std::string more : {"", R"(,"normalized":true)", R"(,"normalized":false)"}) {
            CAPTURE(more);
            const std::vector<std::uint8_t> bytes{0, 0, 0, 255, 51, 0, 255, 0, 0, 0, 0, 255};
            const std::vector<std::uint16_t> words{0, 0, 0, 65535, 13107, 0, 65535, 0, 0, 0, 0, 65535};
            CHECK(near(colour(b.data(raw(bytes).substr(0, 9), 5121, 3, "VEC3", more)), {1, 0.2f, 0}));
            CHECK(near(colour(b.data(raw(bytes), 5121, 3, "VEC4", more)), {0.2f, 0, 1}));
            CHECK(near(colour(b.data(raw(words).substr(0, 18), 5123, 3, "VEC3", more)), {1, 0.2f, 0}));
            CHECK(near(colour(b.data(raw(words), 5123, 3, "VEC4", more)), {0.2f, 0, 1}));
        }
        CHECK(near(colour(b.floats({0, 0, 0, 1, 0.2f, 0, 1, 0, 0}, "VEC3")), {1, 0.2f, 0}));
        CHECK(near(colour(b.floats({0, 0, 0, 1, 0.2f, 0, 1, 1, 0, 0, 0, 1}, "VEC4")), {0.2f, 0, 1}));
    }
    SECTION("colours by other names are lost, or said where there are others") {
        const int rgb = b.floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
        for (const std::string name : {"COLOR_1", "_COLOR", "_Col"}) {
            const std::string further = position + fmt::format(R"(,"{}":{})", name, rgb);
            CHECK_THAT(read(b.file(mesh(further))).lost_colour, Contains(name) && Contains("LOST"));
            const ModelFile both = read(b.file(mesh(further + fmt::format(R"(,"COLOR_0":{})", rgb))));
            CHECK(both.lost_colour.empty());
            CHECK_THAT(warnings(both), Contains(name) && Contains("left aside"));
        }
        CHECK(read(b.file(mesh(position + fmt::format(R"(,"_TEMPERATURE":{})", rgb)))).warnings.empty());
    }
    SECTION("names of files as they are and with %XX") {
        const int uv = b.floats({0.25f, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f}, "VEC2");
        const std::string textured = mesh(
            position + fmt::format(R"(,"TEXCOORD_0":{})", uv),
            R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
            R"("images":[{"uri":"my%20t.png"}])",
            R"(,"material":0)");
        for (const std::string name : {"my t.png", "my%20t.png"}) {
            const ModelFile file = read(b.file(textured), {{name, four_colours()}});
            CHECK(file.lost_colour.empty());
            CHECK(near(corner_colour(file.mesh, 0, 0), {1, 0, 0}));
        }
        CHECK_THAT(read(b.file(textured)).lost_colour, Contains("my t.png"));
    }
    SECTION("a glow that is a picture, its factor left out") {
        const int uv = b.floats({0.25f, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f}, "VEC2");
        const auto with = [&](const std::string& factor) {
            return read(
                b.file(mesh(position + fmt::format(R"(,"TEXCOORD_0":{})", uv),
                            fmt::format(R"(,"materials":[{{{}"emissiveTexture":{{"index":0}},"pbrMetallicRoughness":)"
                                        R"({{"baseColorFactor":[0,0,0,1]}}}}],"textures":[{{"source":0}}],)"
                                        R"("images":[{{"uri":"t.png"}}])",
                                        factor),
                            R"(,"material":0)")),
                {{"t.png", four_colours()}});
        };
        CHECK(near(corner_colour(with("").mesh, 0, 0), {1, 0, 0}));
        CHECK(near(corner_colour(with(R"("emissiveFactor":[1,1,1],)").mesh, 0, 0), {1, 0, 0}));
        CHECK(near(corner_colour(with(R"("emissiveFactor":[0,0,0],)").mesh, 0, 0), {0, 0, 0}));
        const ModelFile alone =
            read(b.file(mesh(position + fmt::format(R"(,"TEXCOORD_0":{})", uv),
                             R"(,"materials":[{"emissiveTexture":{"index":0},"emissiveFactor":[1,1,1]}],)"
                             R"("textures":[{"source":0}],"images":[{"uri":"t.png"}])",
                             R"(,"material":0)")),
                 {{"t.png", four_colours()}});
        CHECK(near(corner_colour(alone.mesh, 0, 0), {1, 0, 0}));
        CHECK_THAT(warnings(alone), Contains("emission"));
    }
    SECTION("a glow beside another colour is left aside, and said once for all materials") {
        const auto said = [&](const std::string& materials) {
            const ModelFile file =
                read(b.file(mesh(position, R"(,"materials":[)" + materials + "]", R"(,"material":0)")));
            return warnings(file);
        };
        const std::string coloured =
            R"({"name":"lamp","emissiveFactor":[0,1,0],"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}})";
        CHECK_THAT(said(coloured), Contains("1 material of") && Contains("('lamp') glows besides") &&
                                       Contains("emission is left aside") && Contains("[which-colour]"));
        CHECK_THAT(said(coloured + R"(,{"emissiveFactor":[0,0,1]})"),
                   Contains("2 materials of") && Contains("('lamp', ...) glow besides"));
        for (const char* none :
             {R"({"emissiveFactor":[0,0,0],"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}})",
              R"({"emissiveTexture":{"index":0},"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}})"})
            CHECK(said(none).empty());
    }
    SECTION("pictures in the text, in base64 or not, with %XX; the text in UTF-16 and with a mark") {
        const int uv = b.floats({0.25f, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f}, "VEC2");
        std::string percent;
        for (const char c : four_colours()) percent += fmt::format("%{:02X}", static_cast<std::uint8_t>(c));
        const auto with = [&](const std::string& uri) {
            return read(b.file(mesh(position + fmt::format(R"(,"TEXCOORD_0":{})", uv),
                                    R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
                                    R"("textures":[{"source":0}],"images":[{"uri":")" +
                                        uri + R"("}])",
                                    R"(,"material":0)")));
        };
        CHECK(near(corner_colour(with("data:image/png," + percent).mesh, 0, 0), {1, 0, 0}));
        std::string base64;
        for (const char c : base64_of(four_colours()))
            base64 += c == '+' ? "%2B" : c == '/' ? "%2F" : c == '=' ? "%3D" : std::string{c};
        CHECK(near(corner_colour(with("data:image/png;base64," + base64).mesh, 0, 0), {1, 0, 0}));

        const std::string json =
            R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
            R"("buffers":[{"byteLength":36,"uri":"p.bin"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
            R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})";
        std::string wide = "\xFF\xFE";
        for (const char c : json) wide += {c, '\0'};
        for (const std::string& text : {json, "\xEF\xBB\xBF" + json, wide}) {
            const Folder folder;
            CHECK(read_model_here(folder.write({{"a.gltf", text}, {"p.bin", raw(triangle)}})).mesh.triangles.size() ==
                  1);
        }
    }
    SECTION("a skin whose joints stand outside the scene, under two roots") {
        const int joints = b.data(std::string("\0\0\0\0\1\0\0\0\0\0\0\0", 12), 5121, 3, "VEC4"),
                  weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
        const ModelFile file = read(b.file(fmt::format(
            R"("scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"skin":0}},{{"translation":[0,5,0]}},)"
            R"({{"translation":[3,0,0],"children":[3]}},{{"translation":[0,0,4]}}],"skins":[{{"joints":[1,3]}}],)"
            R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"JOINTS_0":{},"WEIGHTS_0":{}}}}}]}}])",
            p, joints, weights)));
        const auto at = [&](std::size_t c) { return file.mesh.positions[file.mesh.triangles[0][c]]; };
        CHECK((at(0) - Vector3d(0, 0, 5)).norm() < 1e-6);
        CHECK((at(1) - Vector3d(4, -4, 0)).norm() < 1e-6);  // (1, 0, 0) + (3, 0, 4), z up
        CHECK((at(2) - Vector3d(0, 0, 6)).norm() < 1e-6);
    }
}
