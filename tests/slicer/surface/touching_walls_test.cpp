// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/touching_walls.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr std::array<std::array<std::uint32_t, 3>, 12> faces{{{0, 2, 3},
                                                              {0, 3, 1},
                                                              {4, 5, 7},
                                                              {4, 7, 6},
                                                              {0, 1, 5},
                                                              {0, 5, 4},
                                                              {2, 6, 7},
                                                              {2, 7, 3},
                                                              {0, 4, 6},
                                                              {0, 6, 2},
                                                              {1, 3, 7},
                                                              {1, 7, 5}}};

struct Solid {
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles{faces.begin(), faces.end()};
    Solid(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
        for (int c = 0; c < 8; ++c)
            positions.emplace_back(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(), c & 4 ? high.z() : low.z());
    }
};

/// Both boxes as they are, one after the other.
VisibleSurface surface_of(const Solid& a, const Solid& b) {
    VisibleSurface surface;
    for (const Solid* solid : {&a, &b}) {
        const auto first = static_cast<std::uint32_t>(surface.positions_mm.size());
        for (const auto& [i, j, k] : solid->triangles) {
            surface.source_triangle.push_back(static_cast<std::uint32_t>(surface.triangles.size()));
            surface.triangles.push_back({i + first, j + first, k + first});
            surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
        }
        surface.positions_mm.insert(surface.positions_mm.end(), solid->positions.begin(), solid->positions.end());
    }
    return surface;
}

/// Area left of two boxes; those of a are sources 0 to 11.
double area_left(const Solid& a, const Solid& b, double gap_mm) {
    const TriangleTree first(a.positions, a.triangles), second(b.positions, b.triangles);
    const std::array bodies{BodyOfSurface{&first, 0, 12}, BodyOfSurface{&second, 12, 24}};
    VisibleSurface surface = surface_of(a, b);
    drop_touching_walls(surface, bodies, gap_mm);
    return coloured_area_mm2(surface);
}

}  // namespace

TEST_CASE("The common wall of two boxes is nobody's, whole or in part, touching or a hair apart", "[surface]") {
    const Solid a({0, 0, 0}, {10, 10, 10});
    const double apart = GENERATE(0.0, 1e-6, 0.05);
    CAPTURE(apart);
    // Box b covers 4 x 3 mm of a's wall, and that of itself.
    const Solid b({10 + apart, 2, 2}, {12 + apart, 6, 5});
    const double b_area = 2 * (2 * 4 + 2 * 3 + 4 * 3);
    CHECK(area_left(a, b, 0.085) == Approx(600 + b_area - 2 * 12).margin(14 * 0.1));  // its edge is a piece wide
}

TEST_CASE("Walls with a voxel of air between them stay, and so do edges beside them", "[surface]") {
    const Solid a({0, 0, 0}, {10, 10, 10});
    CHECK(area_left(a, Solid({10.2, 0, 0}, {20, 10, 10}), 0.085) == Approx(600 + 2 * (98 + 98 + 100)));
    // On the same plane, a hair apart: the tops are next to each other and both are seen.
    CHECK(area_left(a, Solid({10.01, 0, 0}, {20.01, 10, 10}), 0.085) == Approx(1200 - 200));
}
