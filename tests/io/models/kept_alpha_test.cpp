// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/models/finish_model.h"
#include "io/pictures/picture.h"
#include "io/pictures/texture.h"
#include "tests/io/models/compressed_samples.h"
#include "tests/io/models/model_checks.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;
using Eigen::Vector2f;
using Eigen::Vector4f;

namespace {

/// 16 x 16 texels of one colour whose alpha grows from 0 to 255 along x and y; `times_alpha`: colours times it.
DecodedImage ramp(bool times_alpha) {
    DecodedImage image;
    image.has_alpha = true;
    image.texels.width_px = image.texels.height_px = 16;
    for (int i = 0; i < 256; ++i)
        for (const int code : {times_alpha ? i : 255, times_alpha ? i / 2 : 128, 0, i})
            image.texels.srgb8.push_back(std::uint8_t(code));
    return image;
}

ModelParts triangle(bool times_alpha = false) {
    ModelParts parts;
    parts.format = "glTF";
    parts.has_colour = true;
    parts.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    PartMaterial& material = parts.materials.emplace_back();
    material.alpha = 0.5f;
    material.through = 0.2f;
    material.glass = true;
    material.image = 0;
    const std::size_t t = parts.add_triangle({0, 1, 2}, 0);
    parts.set_uv(t, {Vector2f(0, 0), Vector2f(1, 0), Vector2f(0, 1)});
    parts.set_rgba(t, {Vector4f(1, 1, 1, 1), Vector4f(1, 0, 0, 0.25f), Vector4f(1, 1, 1, 0)});
    parts.images.push_back(ramp(times_alpha));
    parts.image_names.emplace_back("ramp.png");
    return parts;
}

std::string said(const std::vector<std::string>& warnings) {
    std::string all;
    for (const std::string& warning : warnings) all += warning + "\n";
    return all;
}

ReadOptions keeping(bool alpha) {
    ReadOptions options;
    options.keep_alpha = alpha;
    return options;
}

using Catch::Matchers::Contains;

}  // namespace

TEST_CASE("Alpha of material, corners and texture is kept beside colours that stay as they are") {
    const ModelFile file = finish_model(triangle(), "a.glb", {.keep_alpha = true});
    const SurfaceMaterial& material = file.mesh.materials.at(0);
    CHECK(material.alpha == Approx(0.5 * (1 - 0.2)));
    CHECK(file.mesh.corner_alpha.at(0) == std::array{1.0f, 0.25f, 0.0f});
    CHECK(file.mesh.corner_rgb.at(0)[1] == Eigen::Vector3f(1, 0, 0));
    REQUIRE(material.alpha_texture);
    // The middle of texel (5, 10) from the top left corner.
    const Vector2f uv(5.5f / 16, 1 - 10.5f / 16);
    CHECK(material.alpha_texture->sample(uv.x(), uv.y()).x() == Approx(165.0 / 255).margin(1e-4));
    CHECK(material.texture->sample(uv.x(), uv.y()).x() == Approx(1));
    CHECK_THAT(said(file.warnings), !Contains("[transparent]") && !Contains("LOST") && !Contains("[premultiplied]"));
}

TEST_CASE("Else colours lie over white, and it is said what prints alpha") {
    const ModelFile file = finish_model(triangle(), "a.glb", {});
    CHECK(file.mesh.corner_alpha.empty());
    CHECK_FALSE(file.mesh.materials.at(0).alpha_texture);
    CHECK(file.mesh.corner_rgb.at(0)[2] == Eigen::Vector3f(1, 1, 1));
    CHECK_THAT(said(file.warnings), Contains("laid over white. --alpha translucency") && Contains("LOST"));
}

TEST_CASE("Colours that look multiplied by alpha are told of") {
    CHECK_THAT(said(finish_model(triangle(true), "a.glb", {.keep_alpha = true}).warnings),
               Contains("ramp.png") && Contains("[premultiplied]"));
    CHECK_THAT(said(finish_with_alpha(ramp(true), "a.png").warnings), Contains("[premultiplied]"));
    const Picture picture = finish_with_alpha(ramp(false), "a.png");
    CHECK(picture.warnings.empty());
    CHECK(picture.alpha_texture);
    CHECK_FALSE(finish_picture(ramp(false), "a.png").alpha_texture);
}

TEST_CASE("Colours times alpha are told from straight ones, bright or dark, in 8 bits and in 16") {
    // 32 x 32: alpha falls from the middle, as of a glow or of a soft edge.
    const auto picture = [](double brightness, bool times_alpha, bool noisy, bool deep) {
        DecodedImage image;
        image.has_alpha = true;
        image.texels.width_px = image.texels.height_px = 32;
        for (int i = 0; i < 1024; ++i) {
            const double alpha = std::clamp(1.3 - std::hypot(i % 32 - 16, i / 32 - 16) / 14, 0.0, 1.0);
            const double grain = noisy ? 0.5 + 0.5 * std::sin(i * 12.9) : 1;
            const double red = brightness * grain * (times_alpha ? alpha : 1);
            for (const double value : {red, red / 2, red / 3, alpha}) {
                image.texels.srgb8.push_back(std::uint8_t(std::lround(255 * value)));
                const double linear = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
                image.texels.linear16.push_back(std::uint16_t(std::lround(65535 * linear)));
            }
            if (deep) image.texels.linear16.back() = std::uint16_t(std::lround(65535 * alpha));
        }
        deep ? image.texels.srgb8.clear() : image.texels.linear16.clear();
        return looks_premultiplied(image.texels);
    };
    for (const bool noisy : {false, true})
        for (const bool deep : {false, true}) {
            for (const double brightness : {0.3, 0.6, 0.9, 1.0}) CHECK(picture(brightness, true, noisy, deep));
            for (const double brightness : {0.0, 0.05, 0.1, 0.2, 0.6, 1.0})
                CHECK_FALSE(picture(brightness, false, noisy, deep));
            CHECK_FALSE(picture(0, true, noisy, deep));
        }
    CHECK_THAT(said(finish_picture(ramp(true), "a.png").warnings), Contains("[premultiplied]"));
    CHECK_THAT(said(finish_cut_out(ramp(true), "a.png").warnings), Contains("[premultiplied]"));
    CHECK_THAT(said(finish_model(triangle(true), "a.glb", {}).warnings), Contains("[premultiplied]"));
    CHECK_THAT(said(finish_model(triangle(), "a.glb", {}).warnings), !Contains("[premultiplied]"));
}

TEST_CASE("glTF's transmission counts by its picture, and a volume by what it absorbs and its colour") {
    GltfBuilder b;
    const int p = b.data(raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}), 5126, 3, "VEC3"),
              uv = b.data(raw(std::vector<float>{0.25f, 0.25f, 0.75f, 0.25f, 0.25f, 0.75f}), 5126, 3, "VEC2");
    const auto model = [&](const std::string& base, const std::string& transmission, const std::string& volume) {
        return b.file(fmt::format(
            R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"TEXCOORD_0":{}}},)"
            R"("material":0}}]}}],"materials":[{{"pbrMetallicRoughness":{{{}}},"extensions":{{)"
            R"("KHR_materials_transmission":{{{}}}{}}}}}],"textures":[{{"source":0}},{{"source":1}}],)"
            R"("images":[{{"uri":"colours.png"}},{{"uri":"through.png"}}])",
            p, uv, base, transmission, volume));
    };
    // Red of 102 is 0.4, a number and no colour; the other channels say nothing.
    const test::Files pictures{{"colours.png", four_colours()},
                               {"through.png", png(1, 2, {102, 255, 0, 255, 0, 255, 255, 255})}};
    const auto read = [&](const std::string& gltf, bool keep) {
        return read_alone({{"a.glb", gltf}}, pictures, keeping(keep));
    };
    const std::string textured = R"("baseColorTexture":{"index":0})",
                      through = R"("transmissionFactor":0.5,"transmissionTexture":{"index":1})",
                      volume =
                          R"(,"KHR_materials_volume":{"attenuationDistance":0.01,"attenuationColor":[0.5,1,0.25]})";
    const auto alpha_at = [](const ModelFile& file, std::size_t corner) {
        const SurfaceMaterial& m = file.mesh.materials.at(file.mesh.material_of_triangle[0]);
        const Vector2f at = file.mesh.corner_uv.at(0)[corner];
        return double(m.alpha) * double(m.alpha_texture ? m.alpha_texture->sample(at.x(), at.y()).x() : 1);
    };
    // Absorption of ln 2, 0 and ln 4 over a centimetre; nothing scatters.
    const double within = std::pow(1 - std::exp(-0.0153 * 0.4 * std::log(8) / 3), 0.6);
    for (const std::string& base : {textured, std::string()}) {
        CAPTURE(base);
        const ModelFile plain = read(model(base, through, ""), true), tinted = read(model(base, through, volume), true);
        CHECK(alpha_at(plain, 0) == Approx(1 - 0.5 * 0.4).margin(1e-3));
        CHECK(alpha_at(plain, 2) == Approx(1).margin(1e-4));  // black: none
        CHECK(alpha_at(tinted, 0) == Approx(1 - 0.2 * (1 - within)).margin(1e-3));
        const Eigen::Vector3f bare = base.empty() ? Eigen::Vector3f(1, 1, 1) : Eigen::Vector3f(1, 0, 0);
        CHECK(near(test::corner_colour(plain.mesh, 0, 0), bare));
        CHECK(near(test::corner_colour(tinted.mesh, 0, 0),
                   bare.cwiseProduct(Eigen::Vector3f(1 - 0.2f * 0.5f, 1, 1 - 0.2f * 0.75f))));
        CHECK(plain.lost_colour.empty());
    }
    const ModelFile even = read(model("", R"("transmissionFactor":1)", volume), true);
    CHECK(even.has_colour);
    CHECK(even.mesh.materials.at(0).alpha == Approx(within).epsilon(1e-4));
    CHECK(even.mesh.materials.at(0).alpha_of_lengths);
    CHECK_FALSE(read(model("", R"("transmissionFactor":1)", ""), true).mesh.materials.at(0).alpha_of_lengths);
    CHECK(near(test::corner_colour(even.mesh, 0, 0), {0.5f, 1, 0.25f}));
    // Without the option nothing is looked at, and glass is lost as ever.
    const ModelFile white = read(model("", through, volume), false);
    CHECK(near(test::corner_colour(white.mesh, 0, 0), {1, 1, 1}));
    CHECK_FALSE(white.mesh.materials.at(0).alpha_texture);
    CHECK_THAT(white.lost_colour, Contains("LOST") && Contains("--alpha translucency"));
    // One set of coordinates serves both pictures.
    const std::string moved = R"("transmissionFactor":0.5,"transmissionTexture":{"index":1,"extensions":)"
                              R"({"KHR_texture_transform":{"offset":[0.5,0]}}})";
    CHECK_THAT(read(model(textured, moved, ""), true).lost_colour, Contains("lays its transmission otherwise"));
    CHECK(alpha_at(read(model("", moved, ""), true), 0) == Approx(0.8).margin(1e-3));
}

TEST_CASE("glTF's wax has the colour that its depth shows, and the alpha of what it scatters and absorbs") {
    GltfBuilder b;
    const int p = b.data(raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}), 5126, 3, "VEC3");
    const auto read = [&](const std::string& extensions, bool keep = true) {
        return read_alone({{"a.glb", b.file(fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{)"
                                                        R"("attributes":{{"POSITION":{}}},"material":0}}]}}],)"
                                                        R"("materials":[{{"extensions":{{{}}}}}])",
                                                        p, extensions))}},
                          {}, keeping(keep));
    };
    const std::string milky = R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.75})",
                      volume = R"(,"KHR_materials_volume":{"attenuationDistance":0.001,)"
                               R"("attenuationColor":[0.5,0.5,0.5]})",
                      wax = R"(,"KHR_materials_volume_scatter":{"multiscatterColor":[0.5,0.5,0.5],)"
                            R"("scatterAnisotropy":0.5})";
    // A beam loses ln 2 on a millimetre. Half of the light comes back from the depth where s = 0.2971, by the formula
    // of Kulla and Conty, so that 0.9538 of what is lost is scattered; forwards by a half.
    const auto alpha = [](double absorbed, double scattered) {
        return std::pow(1 - std::exp(-0.0153 * (0.4 * absorbed + scattered)), 0.6);
    };
    const double lost = 10 * std::log(2), scattered = 0.9538 * lost;
    const auto is = [&](const std::string& extensions, double within, double share, double colour) {
        const ModelFile file = read(extensions);
        CAPTURE(extensions);
        CHECK(file.mesh.materials.at(0).alpha == Approx(1 - share * (1 - within)).margin(2e-4));
        CHECK(file.mesh.materials.at(0).rgb.x() == Approx(1 - share * (1 - colour)).margin(1e-4));
        CHECK(file.lost_colour.empty());
    };
    is(milky + volume, alpha(lost, 0), 0.75, 0.5);
    is(milky + volume + wax, alpha(lost - scattered, 0.5 * scattered), 0.75, 0.5);
    is(R"("KHR_materials_transmission":{"transmissionFactor":0.5},)" + milky + volume, alpha(lost, 0), 0.875, 0.5);
    const std::string clear = R"("KHR_materials_transmission":{"transmissionFactor":1})";
    is(clear + volume + R"(,"KHR_materials_scatter":{"multiscatterColorFactor":[1,1,1]})", alpha(lost, 0), 1, 0.5);
    is(clear + volume + R"(,"KHR_materials_scatter":{"scatterStrengthFactor":1})", alpha(0, lost), 1, 1);
    // How far light gets is not said: nothing but that it is lost.
    const ModelFile leaf = read(milky);
    CHECK(leaf.mesh.materials.at(0).alpha == 1);
    CHECK_THAT(leaf.lost_colour, Contains("no volume says how far") && Contains("LOST"));
    CHECK_THAT(read(milky + volume, false).lost_colour, Contains("--alpha translucency"));
    CHECK_THAT(read(R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":1,)"
                    R"("diffuseTransmissionTexture":{"index":0}})" +
                    volume)
                   .lost_colour,
               Contains("diffuseTransmissionTexture"));
}

TEST_CASE("3MF's translucent materials have the alpha of what a beam loses in them") {
    const auto model = [](const std::string& attenuation) {
        return threemf(
            fmt::format(R"(<q:translucentdisplayproperties id="5"><q:translucent name="a" attenuation="{}"/>)"
                        R"(<q:translucent name="b" attenuation="2500 2500 2500"/>)"
                        R"(</q:translucentdisplayproperties>)"
                        R"(<basematerials id="2" displaypropertiesid="5"><base name="a" )"
                        R"(displaycolor="#ff0000"/><base name="b" displaycolor="#00ff00"/></basematerials>)"
                        R"(<object id="1" pid="2" pindex="0">{}</object>)",
                        attenuation, threemf_tetrahedron(1, {"", R"(pid="2" p1="1")", "", ""})),
            R"(<item objectid="1"/>)");
    };
    const auto read = [&](const std::string& attenuation, bool keep) {
        return read_alone({{"a.3mf", model(attenuation)}}, {}, keeping(keep));
    };
    const auto alpha = [](double eta) { return std::pow(1 - std::exp(-0.0153 * eta), 0.6); };
    const ModelFile milk = read("2500 2500 2500", true), wine = read("100 700 1000", true);
    REQUIRE(milk.mesh.corner_alpha.size() == 4);
    CHECK(milk.mesh.corner_alpha[0][0] == Approx(alpha(25)));  // 0.50, as the standard's table has it
    CHECK(wine.mesh.corner_alpha[0][0] == Approx(alpha(1 + 0.4 * 5)));
    CHECK(wine.mesh.corner_alpha[1][2] == Approx(alpha(25)));
    CHECK(near(test::corner_colour(wine.mesh, 0, 0), {1, 0, 0}));
    CHECK(wine.mesh.materials.at(wine.mesh.material_of_triangle[0]).alpha_of_lengths);
    CHECK(wine.lost_colour.empty());
    CHECK(read("-1 2 3", true).mesh.corner_alpha[0][0] == 1);
    const ModelFile opaque = read("100 700 1000", false);
    CHECK(opaque.mesh.corner_alpha.empty());
    CHECK_THAT(opaque.lost_colour, Contains("LOST") && Contains("--alpha translucency"));
}
