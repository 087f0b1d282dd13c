// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/surface_colour.h"

#include <cmath>

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "io/pictures/texture.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector2f;
using Eigen::Vector3f;

namespace {

/// A square of `side_mm` in the plane z = 0 in two triangles, with texture coordinates from 0 to 1 along x and y. Their
/// corners 0 lie at different places, so that no two weights can be exchanged unseen.
io::TexturedMesh square(double side_mm) {
    io::TexturedMesh mesh;
    mesh.positions = {{0, 0, 0}, {side_mm, 0, 0}, {side_mm, side_mm, 0}, {0, side_mm, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 0, 2}};
    mesh.material_of_triangle = {0, 0};
    mesh.materials.emplace_back();
    return mesh;
}

io::TexturedMesh textured_square(double side_mm, io::TexelImage image) {
    io::TexturedMesh mesh = square(side_mm);
    for (const auto& triangle : mesh.triangles) {
        auto& uv = mesh.corner_uv.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) uv[c] = (mesh.positions[triangle[c]].head<2>() / side_mm).cast<float>();
    }
    mesh.materials[0].texture =
        std::make_shared<const io::Texture>(std::move(image), io::Wrap::repeat, io::Wrap::repeat);
    return mesh;
}

/// Linear values, rows from the top.
template <class Value>
io::TexelImage image_of(std::uint32_t size, const Value& value) {
    io::TexelImage image{size, size, {}, std::vector<std::uint16_t>(4 * std::size_t{size} * size)};
    for (std::uint32_t row = 0; row < size; ++row)
        for (std::uint32_t column = 0; column < size; ++column)
            image.set(std::size_t{row} * size + column, Vector3f::Constant(value(column, size - 1 - row)));
    return image;
}

/// The colour of a place (x, y) of a square, in whichever triangle holds it.
Vector3f colour_at(const io::TexturedMesh& mesh, const SurfaceColour& colour, double x, double y) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Eigen::Vector2d start = mesh.positions[a].head<2>();
        Eigen::Matrix2d edges;
        edges << mesh.positions[b].head<2>() - start, mesh.positions[c].head<2>() - start;
        const Eigen::Vector2d uv = edges.inverse() * (Eigen::Vector2d(x, y) - start);
        if (uv.minCoeff() >= 0 && uv.sum() <= 1) return colour.at(t, float(uv.x()), float(uv.y()));
    }
    FAIL("outside of the square");
    return {};
}

/// Root mean square of what the texels of a checker of black and white, one texel wide, differ from grey, times two: 1
/// where each shows its own, 0 where all are grey.
double contrast(double spacing_texels) {
    constexpr std::uint32_t texels = 16;
    constexpr double texel_mm = 0.06;
    const io::TexturedMesh mesh =
        textured_square(texels * texel_mm, image_of(texels, [](auto i, auto j) { return (i + j) % 2 ? 1.0f : 0.0f; }));
    const SurfaceColour colour(mesh, spacing_texels * texel_mm);
    CHECK_FALSE(colour.constant());
    double sum = 0;
    for (std::uint32_t i = 0; i < texels; ++i)
        for (std::uint32_t j = 0; j < texels; ++j) {
            const double seen = colour_at(mesh, colour, (i + 0.5) * texel_mm, (j + 0.5) * texel_mm).x(),
                         own = (i + j) % 2;
            sum += (2 * seen - 1) * (2 * own - 1);
        }
    return sum / (texels * texels);
}

}  // namespace

TEST_CASE("Corner colours are interpolated by their own weights, and multiply the material's") {
    io::TexturedMesh mesh = square(2);
    mesh.corner_rgb = {{Vector3f(1, 0, 0), Vector3f(0, 1, 0), Vector3f(0, 0, 1)},
                       {Vector3f(0.5f, 0.5f, 0), Vector3f(0.25f, 0, 0.5f), Vector3f(0, 1, 1)}};
    mesh.materials[0].rgb = Vector3f(1, 0.5f, 0.25f);
    const SurfaceColour colour(mesh, 0.1);
    // Corner 0 has what corners 1 and 2 leave: 1 - 0.2 - 0.5.
    CHECK((colour.at(0, 0.2f, 0.5f) - Vector3f(0.3f, 0.2f * 0.5f, 0.5f * 0.25f)).norm() < 1e-6f);
    const Vector3f corners =
        0.3f * Vector3f(0.5f, 0.5f, 0) + 0.2f * Vector3f(0.25f, 0, 0.5f) + 0.5f * Vector3f(0, 1, 1);
    CHECK((colour.at(1, 0.2f, 0.5f) - Vector3f(corners.x(), 0.5f * corners.y(), 0.25f * corners.z())).norm() < 1e-6f);
}

TEST_CASE("A material that absorbs has the alpha of one that absorbs as much along the smaller body") {
    io::TexturedMesh mesh = square(2);
    const auto of_absorber = [](double per_cm) { return float(std::pow(1 - std::exp(-0.0153 * 0.4 * per_cm), 0.6)); };
    mesh.materials[0].alpha = of_absorber(3);
    mesh.materials[0].times_as_large = 0.1;
    CHECK(std::abs(SurfaceColour(mesh, 0.1).alpha_at(0, 0.2f, 0.5f) - of_absorber(30)) < 1e-6f);
    mesh.corner_alpha = {{1, 1, 1}, {0, 0, 0}};
    CHECK(std::abs(SurfaceColour(mesh, 0.1).alpha_at(0, 0.2f, 0.5f) - of_absorber(30)) < 1e-6f);
    CHECK(SurfaceColour(mesh, 0.1).alpha_at(1, 0.2f, 0.5f) == 0);
    mesh.materials[0].alpha = 1, mesh.corner_alpha.clear(), mesh.materials[0].times_as_large = 1000;
    CHECK(SurfaceColour(mesh, 0.1).alpha_at(0, 0.2f, 0.5f) == 1);
}

TEST_CASE("A surface has one colour where every corner of every material shows it") {
    io::TexturedMesh mesh = square(1);
    CHECK(SurfaceColour(mesh, 0.1).constant());
    mesh.materials.emplace_back();
    mesh.material_of_triangle = {0, 1};
    CHECK(SurfaceColour(mesh, 0.1).constant());
    mesh.materials[1].rgb = Vector3f(1, 1, 0.5f);
    CHECK_FALSE(SurfaceColour(mesh, 0.1).constant());
    mesh.material_of_triangle = {0, 0};
    CHECK(SurfaceColour(mesh, 0.1).constant());
    mesh.corner_rgb.assign(2, {Vector3f::Ones(), Vector3f::Ones(), Vector3f::Ones()});
    CHECK(SurfaceColour(mesh, 0.1).constant());
    mesh.corner_rgb[1][2] = Vector3f(1, 0.5f, 1);
    CHECK_FALSE(SurfaceColour(mesh, 0.1).constant());
}

TEST_CASE("A ramp of texels shows each place its own colour, in both triangles") {
    constexpr std::uint32_t texels = 64;
    const io::TexturedMesh mesh = textured_square(
        1, image_of(texels,
                    [](auto i, auto j) { return 0.1f + 0.6f * (i + 0.5f) / texels + 0.2f * (j + 0.5f) / texels; }));
    const SurfaceColour colour(mesh, 1.0 / texels);
    double worst = 0;
    // Half a texel from the edges: beyond, the picture begins again.
    for (double x = 0.02; x < 0.98; x += 0.03)
        for (double y = 0.02; y < 0.98; y += 0.03)
            worst = std::max(worst, std::abs(colour_at(mesh, colour, x, y).x() - (0.1 + 0.6 * x + 0.2 * y)));
    // Texels are stored in 16 bits; weights are floats.
    CHECK(worst < 1.0 / 65535 + 1e-6);
}

TEST_CASE("Textures are filtered to the spacing of the samples: a checker keeps what a box of that width leaves") {
    // One texel: itself. Two: two black and two white ones. Between the levels it is a linear blend, half way at the
    // square root of two.
    CHECK(contrast(1) == Approx(1).margin(1e-4));
    CHECK(contrast(std::sqrt(2.0)) == Approx(0.5).margin(1e-4));
    CHECK(contrast(2) == Approx(0).margin(1e-4));
    // Finer than the texels there is nothing to filter.
    CHECK(contrast(0.25) == Approx(1).margin(1e-4));
}
