// SPDX-License-Identifier: GPL-3.0-or-later
//
// What comes over the wall from the reader: the same again, or an error, whatever the bytes.
#include "io/models/model_parts.h"

#include <cstring>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "io/models/finish_model.h"
#include "io/pictures/packed_image.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

DecodedImage two_pixels() {
    DecodedImage image;
    image.texels.width_px = 2;
    image.texels.height_px = 1;
    image.texels.srgb8 = {1, 2, 3, 255, 4, 5, 6, 255};
    image.dpi_x = 300;
    image.warnings = {"a warning"};
    return image;
}

ModelParts textured_triangle() {
    ModelParts parts;
    parts.format = "obj";
    parts.mm_per_file_unit = 1;
    parts.has_colour = true;
    parts.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    parts.materials.emplace_back();
    parts.materials[0].name = "skin";
    parts.materials[0].image = 0;
    parts.materials[0].wrap_u = Wrap::decal;
    parts.images.push_back(two_pixels());
    parts.image_names = {"skin.png"};
    const std::size_t t = parts.add_triangle({0, 1, 2}, 0);
    parts.set_uv(t, {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    parts.set_rgba(t, {Eigen::Vector4f(1, 1, 1, 1), Eigen::Vector4f(0, 1, 1, 1), Eigen::Vector4f(0, 0, 1, 1)});
    return parts;
}

}  // namespace

TEST_CASE("a parsed model comes over the wall whole") {
    const std::vector<std::byte> bytes = pack(textured_triangle());
    const ModelParts parts = unpack_model(bytes);
    CHECK(pack(parts) == bytes);
    CHECK(parts.materials[0].name == "skin");
    CHECK(parts.materials[0].wrap_u == Wrap::decal);
    CHECK(parts.images[0].texels.srgb8 == two_pixels().texels.srgb8);
    CHECK(parts.images[0].warnings == two_pixels().warnings);
    CHECK(finish_model(parts, "a.obj", {}).mesh.triangles.size() == 1);
    CHECK(pack(unpack_image(pack(two_pixels()))) == pack(two_pixels()));
}

TEST_CASE("a parsed model that is cut short or too long is refused") {
    std::vector<std::byte> bytes = pack(textured_triangle());
    for (std::size_t size = 0; size < bytes.size(); ++size)
        CHECK_THROWS_AS(unpack_model(std::span(bytes).first(size)), InputError);
    bytes.push_back(std::byte{0});
    CHECK_THROWS_AS(unpack_model(bytes), InputError);
}

TEST_CASE("a parsed model is unpacked piece by piece, each byte read once, and refused where the pieces end") {
    const std::vector<std::byte> bytes = pack(textured_triangle());
    for (std::size_t size = 0; size <= bytes.size(); ++size) {
        std::size_t at = 0;
        PackedReader reader(size, [&](void* to, std::size_t count) {
            REQUIRE(count <= size - at);
            std::memcpy(to, bytes.data() + at, count);
            at += count;
        });
        if (size < bytes.size()) {
            CHECK_THROWS_AS(unpack_model(reader), InputError);
        } else {
            CHECK(pack(unpack_model(reader)) == bytes);
            CHECK(at == bytes.size());
        }
    }
    DecodedImage image = two_pixels();
    image.lost_colour = "layers are LOST";
    CHECK(unpack_image(pack(image)).lost_colour == image.lost_colour);
}

TEST_CASE("parts that do not fit together are refused") {
    const auto refused = [](auto change) {
        ModelParts parts = textured_triangle();
        change(parts);
        CHECK_THROWS_WITH(unpack_model(pack(parts)), Contains("what the reader left"));
    };
    refused([](ModelParts& p) { p.material_of_triangle.clear(); });
    refused([](ModelParts& p) { p.image_names.clear(); });
    refused([](ModelParts& p) { p.corner_uv.resize(2); });
    refused([](ModelParts& p) { p.corner_rgba.resize(2); });
    refused([](ModelParts& p) { p.materials[0].wrap_v = static_cast<Wrap>(9); });
    refused([](ModelParts& p) { p.images[0].texels.width_px = 3; });
    refused([](ModelParts& p) { p.images[0].texels.width_px = 0; });
    refused([](ModelParts& p) { p.images[0].texels.srgb8.pop_back(); });
    refused([](ModelParts& p) { p.images[0].texels.linear16.resize(8); });
}

TEST_CASE("wrong bytes in a parsed model give a model or an error") {
    const std::vector<std::byte> whole = pack(textured_triangle());
    int models = 0, refused = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        RandomStream random(5, i, 0);
        std::vector<std::byte> wrong = whole;
        for (std::size_t k = 0; k < 1 + i % 3; ++k)
            wrong[random.bits() % wrong.size()] = static_cast<std::byte>(random.bits() & 255);
        try {
            (void)finish_model(unpack_model(wrong), "a.obj", {});
            ++models;
        } catch (const InputError&) {
            ++refused;
        }
    }
    CHECK(models + refused == 3000);
    CHECK(refused > 300);
}
