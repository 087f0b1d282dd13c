// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <array>
#include <string>
#include <vector>

#include "io/models/finish_model.h"
#include "io/pictures/picture.h"
#include "io/pictures/texture.h"

using namespace voxtone;
using namespace voxtone::io;
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
