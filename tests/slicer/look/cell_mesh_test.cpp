// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <set>

#include <Eigen/Geometry>

#include "slicer/look/cell_mesh.h"
#include "slicer/look/prediction_files.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

struct MeshFigures {
    std::size_t open_edges = 0;  ///< directed edges without their opposite
    double volume_mm3 = 0;       ///< > 0 where triangles look outward
    long euler = 0;
};

MeshFigures figures(const optics::Surface& surface, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    std::set<std::uint32_t> vertices;
    MeshFigures f;
    const auto point = [&](std::uint32_t i) {
        const auto& c = surface.cells[i].centre_mm;
        return Eigen::Vector3d(c[0], c[1], c[2]);
    };
    for (const auto& t : triangles) {
        for (std::size_t e = 0; e < 3; ++e) {
            ++edges[{t[e], t[(e + 1) % 3]}];
            vertices.insert(t[e]);
        }
        f.volume_mm3 += point(t[0]).dot(point(t[1]).cross(point(t[2]))) / 6;
    }
    std::size_t directed = 0;
    for (const auto& [edge, n] : edges) {
        directed += static_cast<std::size_t>(n);
        const auto opposite = edges.find({edge.second, edge.first});
        f.open_edges += opposite == edges.end() || opposite->second != n;
    }
    f.euler =
        static_cast<long>(vertices.size()) - static_cast<long>(directed / 2) + static_cast<long>(triangles.size());
    return f;
}

}  // namespace

TEST_CASE("The cells of a ball are a closed mesh that looks outward, of the ball's volume") {
    const double radius = 1.5;
    const std::array<int, 3> size{72, 36, 112};
    const optics::ResinVolume volume = optics::make_resin_volume(size, j750, [&](int x, int y, int z) {
        const double dx = (x + 0.5) * j750[0] - 1.52, dy = (y + 0.5) * j750[1] - 1.52, dz = (z + 0.5) * j750[2] - 1.51;
        return dx * dx + dy * dy + dz * dz < radius * radius ? 1 : 0;
    });
    const optics::Surface surface = optics::find_surface({&volume, nullptr}, {2, 1, 3}, optics::SurfacePart::all);
    const MeshFigures f = figures(surface, cell_triangles(volume, surface));
    CHECK(f.open_edges == 0);
    CHECK(f.euler == 2);
    // Vertices are up to half a cell (0.04 mm) inside or outside of the ball: 3 * 0.04 / 1.5 of its volume at the very
    // most.
    CHECK(f.volume_mm3 == Approx(4.0 / 3 * M_PI * radius * radius * radius).epsilon(0.08));
}

TEST_CASE("Boxes, rings and bodies that touch along an edge are closed meshes, one on a sheet is open below") {
    const auto mesh = [](const optics::ResinVolume& volume, optics::Backing backing) {
        const optics::Surface surface =
            optics::find_surface({&volume, nullptr, backing}, {2, 1, 3}, optics::SurfacePart::all);
        return figures(surface, cell_triangles(volume, surface));
    };
    const optics::ResinVolume box = optics::make_resin_volume({40, 20, 60}, j750, [](int, int, int) { return 1; });
    const MeshFigures whole = mesh(box, optics::Backing::none);
    CHECK(whole.open_edges == 0);
    CHECK(whole.euler == 2);
    const double volume = 40 * j750[0] * 20 * j750[1] * 60 * j750[2];
    CHECK(whole.volume_mm3 < volume);
    CHECK(whole.volume_mm3 > 0.95 * volume);  // its edges are cut
    CHECK(mesh(box, optics::Backing::black).open_edges > 0);
    const optics::ResinVolume ring = optics::make_resin_volume(
        {40, 20, 60}, j750, [](int x, int y, int) { return x >= 12 && x < 28 && y >= 6 && y < 14 ? 0 : 1; });
    CHECK(mesh(ring, optics::Backing::none).open_edges == 0);
    CHECK(mesh(ring, optics::Backing::none).euler == 0);
    const optics::ResinVolume two =
        optics::make_resin_volume({40, 20, 30}, j750, [](int x, int y, int) { return (x < 20) == (y < 10) ? 1 : 0; });
    CHECK(mesh(two, optics::Backing::none).open_edges == 0);
    CHECK(mesh(two, optics::Backing::none).euler == 4);  // two bodies
}

TEST_CASE("A letter is upright and not mirrored in the picture of a slab") {
    // F: a stem on the left, a long bar at the top (largest y), a shorter one in the middle; 5 x 7 cells of 2 x 1 x 3
    // voxels.
    const char* const letter[] = {"#####", "#....", "#....", "####.", "#....", "#....", "#...."};
    const optics::ResinVolume volume = optics::make_resin_volume(
        {10, 7, 6}, j750, [&](int x, int y, int) { return letter[6 - y][x / 2] == '#' ? 1 : 2; });
    SurfacePrediction prediction;
    prediction.surface = optics::find_surface({&volume, nullptr}, {2, 1, 3}, optics::SurfacePart::top);
    prediction.channels = 3;
    for (const optics::SurfaceCell& cell : prediction.surface.cells) {
        const optics::SurfaceFace& face = prediction.surface.faces[cell.first_face];
        const float value = volume.at(face.voxel[0], face.voxel[1], face.voxel[2]) == 1 ? 0.25f : 0.75f;
        prediction.rgb.push_back(Eigen::Vector3f::Constant(value));
        for (int c = 0; c < 3; ++c) prediction.value.push_back(value);
    }
    prediction.standard_error.assign(prediction.value.size(), 0.125f);
    const io::LinearPicture picture = top_picture(volume, prediction);
    const io::NumberPicture numbers = top_numbers(volume, {}, prediction);
    REQUIRE(picture.width_px == 5);
    REQUIRE(picture.height_px == 7);
    REQUIRE(numbers.names == std::vector<std::string>{"R", "G", "B", "A", "error.R", "error.G", "error.B"});
    for (std::size_t row = 0; row < 7; ++row)
        for (std::size_t x = 0; x < 5; ++x) {
            const float expected = letter[row][x] == '#' ? 0.25f : 0.75f;
            CHECK(picture.pixels[row * 5 + x] == Eigen::Vector4f(expected, expected, expected, 1));
            CHECK(numbers.values[(row * 5 + x) * 7 + 1] == expected);
            CHECK(numbers.values[(row * 5 + x) * 7 + 6] == 0.125f);
        }
}
