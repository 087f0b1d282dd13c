// SPDX-License-Identifier: GPL-3.0-or-later
//
// The target as a diffuser, and the light that comes from a picture.
#include <cmath>
#include <numbers>
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/pictures/exr_writer.h"
#include "slicer/proof/diffuse_mesh.h"
#include "slicer/proof/proof_light.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

optics::Point unit(double x, double y, double z) {
    const double length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}

constexpr std::uint32_t columns = 16, rows = 8;

/// Dim everywhere but for one pixel, whose red is 100.
std::string one_lamp(const io::TemporaryFolder& folder, std::uint32_t column, std::uint32_t row) {
    io::NumberPicture picture{
        columns, rows, {"R", "G", "B"}, std::vector<float>(std::size_t{columns} * rows * 3, 1.0f)};
    picture.values[(std::size_t{row} * columns + column) * 3] = 100;
    const std::string file = (folder.path() / "light.exr").string();
    std::filesystem::remove(file);
    io::write_whole_file(file, io::exr_bytes(picture));
    return file;
}

/// Where a pixel of the picture lies. Its first row is the zenith and its middle -y; who looks there has -x at his
/// right hand.
optics::Point direction_of(std::uint32_t column, std::uint32_t row) {
    const double right = 2 * std::numbers::pi * ((column + 0.5) / columns - 0.5),
                 down = std::numbers::pi * (row + 0.5) / rows;
    return {std::sin(down) * -std::sin(right), std::sin(down) * -std::cos(right), std::cos(down)};
}

optics::Point turned(const optics::Point& p, double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {std::cos(a) * p[0] - std::sin(a) * p[1], std::sin(a) * p[0] + std::cos(a) * p[1], p[2]};
}

}  // namespace

TEST_CASE("A target reflects the colour between its corners where a ray meets it, moved and under its white") {
    const io::ColouredMesh mesh{
        {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}, {{1, 0, 0.5f}, {0, 1, 0.25f}, {0.5f, 0.5f, 1}}, {{0, 1, 2}}};
    const DiffuseMesh target(mesh, Vector3d(10, 20, 30), Vector3d(0.5, 1, 3), {});
    double distance = 0;
    optics::BoundaryNormals normals;
    optics::Light reflectance{};
    // From above, at a quarter of corner 1 and a half of corner 2: x = 1, y = 2.
    REQUIRE(target.meets({11, 22, 36}, {0, 0, -1}, distance, normals, reflectance));
    CHECK(distance == Approx(5));
    const Vector3f rgb = 0.25f * mesh.rgb[0] + 0.25f * mesh.rgb[1] + 0.5f * mesh.rgb[2];
    CHECK(reflectance[0] == Approx(0.5 * rgb[0]).epsilon(1e-5));
    CHECK(reflectance[1] == Approx(rgb[1]).epsilon(1e-5));
    // Three times blue is more than all light: each corner is cut at 1 (1 of 1.5, 0.75, 1 of 3).
    CHECK(reflectance[2] == Approx(0.25 * 1 + 0.25 * 0.75 + 0.5 * 1).epsilon(1e-5));
    CHECK(normals.geometric[2] == Approx(1));
    CHECK_FALSE(target.meets({11, 22, 36}, {0, 0, 1}, distance, normals, reflectance));
    CHECK_FALSE(target.meets({14, 24, 36}, {0, 0, -1}, distance, normals, reflectance));
    CHECK_FALSE(target.meets({1, 2, 6}, {0, 0, -1}, distance, normals, reflectance));  // it was there before
}

TEST_CASE("A picture of all directions lights from where its pixels lie, as one sees them from the print") {
    const io::TemporaryFolder folder;
    Progress progress;
    for (const auto& [column, row] : {std::pair{8u, 4u}, std::pair{11u, 2u}, std::pair{1u, 5u}, std::pair{5u, 3u}})
        for (const double turn : {0.0, 90.0}) {
            CAPTURE(column, row, turn);
            const optics::Sky sky = light_of({one_lamp(folder, column, row), {}}, turn, progress);
            const optics::Light lamp = sky.radiance(turned(direction_of(column, row), turn)),
                                open = sky.radiance(turned(direction_of((column + 3) % columns, row), turn));
            CHECK(lamp[0] == Approx(100 * open[0]));
            CHECK(lamp[1] == Approx(open[1]));
            std::size_t bright = 0;
            for (std::uint32_t c = 0; c < columns; ++c)
                for (std::uint32_t r = 0; r < rows; ++r) bright += sky.radiance(direction_of(c, r))[0] > 2 * open[0];
            CHECK(bright == 1);
        }
}

TEST_CASE("A white diffuser in the open has 1 in every light") {
    const auto upward = [](const optics::Sky& sky) { return optics::luminance(sky.irradiance({0, 0, 1})); };
    Progress progress;
    for (const ProofLight light : {ProofLight::studio, ProofLight::overcast})
        CHECK(upward(light_of({"", light}, 0, progress)) == Approx(std::numbers::pi).epsilon(1e-3));
    CHECK(light_of({"", ProofLight::even}, 0, progress).radiance(unit(1, 2, -3)) == optics::Light{1, 1, 1});
    const io::TemporaryFolder folder;
    CHECK(upward(light_of({one_lamp(folder, 3, 1), {}}, 0, progress)) == Approx(std::numbers::pi).epsilon(1e-3));
}

TEST_CASE("What is no picture of all directions, or dark above, is refused in a sentence") {
    const io::TemporaryFolder folder;
    Progress progress;
    const ProofLamp lamp{(folder.path() / "light.exr").string(), {}};
    const auto write = [&](std::uint32_t width, std::uint32_t height, float above) {
        io::NumberPicture picture{width, height, {"R", "G", "B"}, {}};
        for (std::uint32_t row = 0; row < height; ++row)
            picture.values.insert(picture.values.end(), std::size_t{width} * 3, row < height / 2 ? above : 1.0f);
        std::filesystem::remove(lamp.words);
        io::write_whole_file(lamp.words, io::exr_bytes(picture));
    };
    write(8, 8, 1);
    CHECK_THROWS_WITH(light_of(lamp, 0, progress), Catch::Contains("8 x 8") && Catch::Contains("twice as wide"));
    write(8, 4, 0);
    CHECK_THROWS_WITH(light_of(lamp, 0, progress), Catch::Contains("dark above its horizon"));
    CHECK_THROWS_AS(light_of(lamp, 0, progress), InputError);
    write(8, 4, 1);
    CHECK_NOTHROW(light_of(lamp, 0, progress));
}
