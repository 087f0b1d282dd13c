// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>

#include "base/random.h"
#include "slicer/layers/cell_index.h"
#include "slicer/layers/skin_source.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr std::array<double, 3> pitch{25.4 / 600, 25.4 / 300, 0.027};

/// A ball of white resin.
optics::Surface ball(optics::ResinVolume& volume, double radius_mm) {
    std::array<int, 3> size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<int>(2 * radius_mm / pitch[a]) + 2;
    volume = optics::make_resin_volume(size, pitch, [&](int x, int y, int z) {
        const std::array<int, 3> at{x, y, z};
        double square = 0;
        for (std::size_t a = 0; a < 3; ++a) square += std::pow((at[a] + 0.5) * pitch[a] - radius_mm, 2);
        return square < radius_mm * radius_mm ? 1 : 0;
    });
    static const optics::ResinSet set = optics::vero_opaque();
    return optics::find_surface({&volume, &set, optics::Backing::none, optics::Sides::open}, {2, 1, 3},
                                optics::SurfacePart::all);
}

}  // namespace

TEST_CASE("Every surface cell is found at its own centre, and places near it find a near one", "[loop]") {
    optics::ResinVolume volume;
    const optics::Surface surface = ball(volume, 0.9);
    const CellIndex index(surface, pitch);
    const double cell_mm = 0.085;
    for (std::size_t c = 0; c < surface.cells.size(); ++c) {
        const auto& centre = surface.cells[c].centre_mm;
        const std::uint32_t found = index.at({centre[0], centre[1], centre[2]});
        const auto& there = surface.cells[found].centre_mm;
        // A centre on a border between two places may belong to the neighbour.
        CHECK(std::hypot(there[0] - centre[0], there[1] - centre[1], there[2] - centre[2]) <= 1.01 * cell_mm);
        if (found != c) continue;
        CHECK(found == c);
    }
    // Points of the true sphere, where the staircase need not have a face.
    for (std::uint64_t n = 0; n < 2000; ++n) {
        RandomStream random(3, n);
        Eigen::Vector3d d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        const Eigen::Vector3f place = (0.9 * d.normalized() + Eigen::Vector3d::Constant(0.9)).cast<float>();
        const auto& there = surface.cells[index.at(place)].centre_mm;
        CHECK(std::hypot(there[0] - place.x(), there[1] - place.y(), there[2] - place.z()) < 2 * cell_mm);
    }
    // Far outside: still some cell.
    CHECK(index.at({100, 100, 100}) < surface.cells.size());
    CHECK(index.at({-100, 0, 0}) < surface.cells.size());
}

TEST_CASE("Places on triangles come from their place in the source triangle", "[loop]") {
    VisibleSurface surface;
    surface.positions_mm = {{1, 1, 0}, {3, 1, 0}, {1, 5, 0}, {2, 2, 0}};
    surface.triangles = {{0, 1, 2}, {3, 1, 2}, {0, 1, 2}};
    surface.source_triangle = {0, 0, 1};
    const auto corner = [](float u, float v) { return Eigen::Vector2f(u, v); };
    surface.source_uv = {{{corner(0, 0), corner(1, 0), corner(0, 1)}},         // the source itself
                         {{corner(0.5f, 0.25f), corner(1, 0), corner(0, 1)}},  // a piece of it
                         {{corner(1, 0), corner(1, 0), corner(1, 0)}}};        // a patch with one colour
    surface.positions_mm[3] = {2, 2, 0};
    const SurfacePlaces places(surface, {1, 1, 0});
    const auto near = [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return (a - b).norm() < 1e-5f; };
    CHECK(near(places.at(0, 0.25f, 0.5f), {0.5f, 2, 0}));
    CHECK(near(places.at(1, 0.5f, 0.25f), {1, 1, 0}));
    CHECK(near(places.at(1, 1, 0), {2, 0, 0}));
    CHECK(near(places.at(2, 1, 0), {2.0f / 3, 4.0f / 3, 0}));
}
