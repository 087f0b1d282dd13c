// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/viewer_surface.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "io/pictures/srgb_code.h"
#include "io/report/viewer_data.h"
#include "slicer/look/clustered_mesh.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// A closed ball of rings.
io::ColouredMesh ball(int rings, float radius_mm) {
    io::ColouredMesh mesh;
    const int around = 2 * rings;
    mesh.positions_mm.emplace_back(0, 0, -radius_mm);
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            const double polar = std::numbers::pi * (1 - double(i) / rings), turn = 2 * std::numbers::pi * j / around;
            mesh.positions_mm.push_back(radius_mm * Eigen::Vector3d(std::sin(polar) * std::cos(turn),
                                                                    std::sin(polar) * std::sin(turn), std::cos(polar))
                                                        .cast<float>());
        }
    mesh.positions_mm.emplace_back(0, 0, radius_mm);
    const auto at = [&](int ring, int place) { return std::uint32_t(1 + (ring - 1) * around + place % around); };
    const auto top = std::uint32_t(mesh.positions_mm.size() - 1);
    for (int j = 0; j < around; ++j) {
        mesh.triangles.push_back({0, at(1, j + 1), at(1, j)});
        for (int i = 1; i + 1 < rings; ++i) {
            mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
            mesh.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
        }
        mesh.triangles.push_back({at(rings - 1, j), at(rings - 1, j + 1), top});
    }
    return mesh;
}

template <class Positions, class Triangles>
double volume_mm3(const Positions& p, const Triangles& triangles) {
    double six = 0;
    for (const auto& t : triangles)
        six +=
            p[t[0]].template cast<double>().dot(p[t[1]].template cast<double>().cross(p[t[2]].template cast<double>()));
    return six / 6;
}

/// Edges that are not run as often one way as the other.
std::size_t open_edges(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> run;
    for (const auto& t : triangles)
        for (std::size_t e = 0; e < 3; ++e) {
            const std::uint32_t a = t[e], b = t[(e + 1) % 3];
            run[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    std::size_t open = 0;
    for (const auto& [edge, sum] : run) open += sum != 0;
    return open;
}

}  // namespace

TEST_CASE("A mesh with fewer vertices is closed as before and has nearly the volume") {
    const io::ColouredMesh fine = ball(120, 10);
    REQUIRE(open_edges(fine.triangles) == 0);
    const ClusteredMesh few = clustered(fine.positions_mm, fine.triangles, 3000, 0.2);
    CHECK(few.positions_mm.size() <= 3000);
    CHECK(few.positions_mm.size() > 1500);
    CHECK(open_edges(few.triangles) == 0);
    // Chords of cubes of `cube_mm`: a sagitta of cube^2 / (8 r) below the ball, some of it on both sides.
    CHECK(volume_mm3(few.positions_mm, few.triangles) ==
          Approx(volume_mm3(fine.positions_mm, fine.triangles)).epsilon(0.01));
    for (std::size_t i = 0; i < fine.positions_mm.size(); ++i)
        CHECK((few.positions_mm[few.vertex_of[i]] - fine.positions_mm[i]).norm() <= std::sqrt(3.0) * few.cube_mm);
    const ClusteredMesh same = clustered(fine.positions_mm, fine.triangles, fine.positions_mm.size(), 0.2);
    CHECK(same.positions_mm == fine.positions_mm);
    CHECK(same.cube_mm == 0);
}

TEST_CASE("The two sides of a wall thinner than a cube stay apart") {
    // A plate of 20 x 20 x 0.1 mm as two sheets.
    io::ColouredMesh plate;
    constexpr std::uint32_t n = 100;
    for (const float z : {0.0f, 0.1f})
        for (std::uint32_t j = 0; j <= n; ++j)
            for (std::uint32_t i = 0; i <= n; ++i) plate.positions_mm.emplace_back(0.2f * float(i), 0.2f * float(j), z);
    for (const std::uint32_t sheet : {0u, 1u})
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t a = sheet * (n + 1) * (n + 1) + j * (n + 1) + i, b = a + 1, c = a + n + 1,
                                    d = c + 1;
                plate.triangles.push_back(sheet ? std::array{a, b, c} : std::array{a, c, b});
                plate.triangles.push_back(sheet ? std::array{b, d, c} : std::array{b, c, d});
            }
    const ClusteredMesh few = clustered(plate.positions_mm, plate.triangles, 2000, 0.2);
    CHECK(few.cube_mm > 0.3);
    for (std::size_t i = 0; i < plate.positions_mm.size(); ++i)
        CHECK(few.positions_mm[few.vertex_of[i]].z() == Approx(plate.positions_mm[i].z()).margin(1e-5));
}

TEST_CASE("A body in the page has its colours, and their means where places were taken together") {
    const io::ColouredMesh mesh = ball(40, 10);
    SurfaceLooks looks;
    looks.looks = {{"target", "", {}}, {"print", "", {}}};
    for (const Eigen::Vector3f& p : mesh.positions_mm) {
        looks.looks[0].rgb.emplace_back(0.2f, 0.5f, p.z() > 0 ? 0.9f : 0.1f);
        looks.looks[1].rgb.emplace_back(0.3f, 1.5f, -0.2f);  // not what sRGB can hold
        looks.seen.push_back(p.z() > 0 ? 3.14 : 100);
    }
    const io::ViewerSurface all = viewer_body(mesh, looks, 0.4, 10 << 20);
    REQUIRE(all.positions.size() == 3 * mesh.positions_mm.size());
    for (std::size_t i = 0; i < mesh.positions_mm.size(); ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            const double mm = all.low_mm[a] + (all.high_mm[a] - all.low_mm[a]) * all.positions[3 * i + a] / 65535;
            CHECK(mm == Approx(double(mesh.positions_mm[i][Eigen::Index(a)])).margin(20.0 / 65535));
        }
        CHECK(all.looks[0].rgb[3 * i + 2] == io::linear_to_srgb8(mesh.positions_mm[i].z() > 0 ? 0.9f : 0.1f));
        CHECK(all.looks[1].rgb[3 * i + 1] == 255);
        CHECK(all.looks[1].rgb[3 * i + 2] == 0);
        CHECK(all.seen[i] == (mesh.positions_mm[i].z() > 0 ? 31 : 255));
    }
    CHECK(all.single.empty());
    // A small page: fewer places, no colour that was not there.
    const io::ViewerSurface few = viewer_body(mesh, looks, 0.4, 20'000);
    CHECK(few.positions.size() < all.positions.size() / 2);
    CHECK(io::packed_bytes(few) <= 20'000);
    for (std::size_t i = 0; i < few.seen.size(); ++i) CHECK(few.looks[0].rgb[3 * i] == io::linear_to_srgb8(0.2f));
    // Noise fits too.
    std::uint32_t state = 1;
    for (SurfaceLook& look : looks.looks)
        for (Eigen::Vector3f& rgb : look.rgb)
            for (float& value : rgb) value = float((state = state * 1664525 + 1013904223) >> 8) / (1 << 24);
    CHECK(io::packed_bytes(viewer_body(mesh, looks, 0.4, 20'000)) <= 20'000);
}

TEST_CASE("A picture in the page has the pixels of its cells, the row of the largest y first") {
    // A slab of 12 x 10 x 2 voxels in cells of 2 x 1 x 2; nothing in one corner.
    const auto volume = optics::make_resin_volume({12, 10, 2}, {0.05, 0.1, 0.05}, [](int x, int y, int) {
        return x < 2 && y == 9 ? optics::air : optics::Material{1};
    });
    const optics::ResinSet resins = optics::vero_opaque();
    const optics::Scene scene{.volume = &volume, .resins = &resins, .backing = optics::Backing::black};
    const optics::Surface surface = optics::find_surface(scene, {2, 1, 2}, optics::SurfacePart::top);
    SurfaceLooks looks;
    looks.looks = {{"target", "", {}}};
    for (const optics::SurfaceCell& cell : surface.cells) {
        looks.looks[0].rgb.emplace_back(float(cell.cell[0]) / 8, float(cell.cell[1]) / 16, 0.5f);
        looks.single.push_back(0.1 * (cell.cell[0] + 6 * cell.cell[1]));
    }
    const io::ViewerSurface picture = viewer_picture(volume, surface, looks, 1 << 20);
    REQUIRE(picture.size_px == std::array<std::uint32_t, 2>{6, 10});
    CHECK(picture.high_mm[0] == Approx(0.6));
    CHECK(picture.high_mm[1] == Approx(1));
    CHECK(picture.low_mm[1] == Approx(0).margin(1e-12));
    for (std::uint32_t row = 0; row < 10; ++row)
        for (std::uint32_t column = 0; column < 6; ++column) {
            const std::size_t at = row * 6 + column;
            const int y = 9 - int(row);
            CHECK(picture.covered[at] == (column == 0 && y == 9 ? 0 : 1));
            if (!picture.covered[at]) continue;
            CHECK(picture.looks[0].rgb[3 * at] == io::linear_to_srgb8(float(column) / 8));
            CHECK(picture.looks[0].rgb[3 * at + 1] == io::linear_to_srgb8(float(y) / 16));
            CHECK(int(picture.single[at]) == int(column) + 6 * y);
        }
}
