// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
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

namespace {

struct Cells {
    explicit Cells(double radius_mm = 0.9) : surface(ball(volume, radius_mm)) {}
    [[nodiscard]] double distance(std::uint32_t c, const std::array<double, 3>& p) const {
        const auto& centre = surface.cells[c].centre_mm;
        return std::hypot(centre[0] - p[0], centre[1] - p[1], centre[2] - p[2]);
    }
    [[nodiscard]] double size_mm(std::size_t a) const { return surface.cell_voxels[a] * pitch[a]; }
    /// What the index promises of a place of the viewing grid, by looking at all cells: among those of the 27 places
    /// around it the one nearest to its middle. Those as near to rounding are all right; none: no cell is so near.
    [[nodiscard]] std::vector<std::uint32_t> wanted(const std::array<int, 3>& place) const {
        std::array<double, 3> middle{};
        for (std::size_t a = 0; a < 3; ++a) middle[a] = (place[a] + 0.5) * size_mm(a);
        std::vector<std::uint32_t> around;
        double least = 1e9;
        for (std::uint32_t c = 0; c < surface.cells.size(); ++c) {
            const auto& at = surface.cells[c].cell;
            bool near = true;
            for (std::size_t a = 0; a < 3; ++a) near = near && std::abs(at[a] - place[a]) <= 1;
            if (near) around.push_back(c), least = std::min(least, distance(c, middle));
        }
        std::erase_if(around, [&](std::uint32_t c) { return distance(c, middle) > least + 1e-6; });
        return around;
    }
    [[nodiscard]] std::array<int, 3> place_of(const Eigen::Vector3f& p) const {
        std::array<int, 3> place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = int(std::floor(double(p[int(a)]) / size_mm(a)));
        return place;
    }

    optics::ResinVolume volume;
    optics::Surface surface;
};

bool holds(const std::vector<std::uint32_t>& cells, std::uint32_t cell) {
    return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

}  // namespace

TEST_CASE("Every surface cell is found in the middle of its own place, unless a neighbour's centre is nearer",
          "[loop]") {
    const Cells cells;
    const CellIndex index(cells.surface, pitch);
    std::size_t own = 0;
    for (std::uint32_t c = 0; c < cells.surface.cells.size(); ++c) {
        const auto& place = cells.surface.cells[c].cell;
        Eigen::Vector3f middle;
        for (int a = 0; a < 3; ++a) middle[a] = float((place[std::size_t(a)] + 0.5) * cells.size_mm(std::size_t(a)));
        const std::vector<std::uint32_t> wanted = cells.wanted(place);
        const std::uint32_t found = index.at(middle);
        if (!holds(wanted, found)) CHECK(found == wanted[0]);
        if (wanted == std::vector{c}) CHECK(found == c);
        own += found == c;
    }
    // Faces lie on the sides of cells, so a neighbour's centre may be nearer to the middle, but of few cells it is.
    CHECK(own > cells.surface.cells.size() * 8 / 10);
}

TEST_CASE("Points of the surface, and points beside it, find the cell that all cells say", "[loop]") {
    const Cells cells;
    const CellIndex index(cells.surface, pitch);
    int without = 0;
    for (std::uint64_t n = 0; n < 2000; ++n) {
        RandomStream random(3, n);
        const Eigen::Vector3d d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        // Of the true sphere, where the staircase need not have a face; and up to two cells off it.
        const double radius = n % 2 ? 0.9 : 0.73 + 0.34 * random.uniform();
        const Eigen::Vector3f point = (radius * d.normalized() + Eigen::Vector3d::Constant(0.9)).cast<float>();
        std::array<int, 3> place = cells.place_of(point);
        // What lies beyond the last cell belongs to the last place.
        for (std::size_t a = 0; a < 3; ++a) {
            int last = 0;
            for (const optics::SurfaceCell& cell : cells.surface.cells) last = std::max(last, int{cell.cell[a]});
            place[a] = std::clamp(place[a], 0, last);
        }
        const std::vector<std::uint32_t> wanted = cells.wanted(place);
        const std::uint32_t found = index.at(point);
        if (!wanted.empty()) {
            if (!holds(wanted, found)) CHECK(found == wanted[0]);
            continue;
        }
        // Farther than a place from every cell: about as near as the nearest is.
        ++without;
        const std::array<double, 3> p{point.x(), point.y(), point.z()};
        double least = 1e9;
        for (std::uint32_t c = 0; c < cells.surface.cells.size(); ++c) least = std::min(least, cells.distance(c, p));
        CHECK(cells.distance(found, p) < least + 2 * 0.085);
    }
    CHECK(without > 0);
    // Far outside: still some cell.
    CHECK(index.at({100, 100, 100}) < cells.surface.cells.size());
    CHECK(index.at({-100, 0, 0}) < cells.surface.cells.size());
}

TEST_CASE("Far inside, beyond the places that are looked up, the nearest cell of all is found", "[loop]") {
    const Cells cells(1.5);
    const CellIndex index(cells.surface, pitch);
    for (std::uint64_t n = 0; n < 300; ++n) {
        RandomStream random(4, n);
        const Eigen::Vector3d d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        const Eigen::Vector3f point =
            (0.1 * random.uniform() * d.normalized() + Eigen::Vector3d::Constant(1.5)).cast<float>();
        const std::array<double, 3> p{point.x(), point.y(), point.z()};
        double least = 1e9;
        for (std::uint32_t c = 0; c < cells.surface.cells.size(); ++c) least = std::min(least, cells.distance(c, p));
        CHECK(cells.distance(index.at(point), p) < least + 1e-5);
    }
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
