// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_gap.h"

#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

struct Mesh {
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    [[nodiscard]] TriangleTree tree() const { return {positions, triangles}; }
};

Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    Mesh mesh;
    for (int c = 0; c < 8; ++c)
        mesh.positions.emplace_back(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(), c & 4 ? high.z() : low.z());
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// Of two boxes along the axes.
double distance(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) { return a.exteriorDistance(b); }

}  // namespace

TEST_CASE("Boxes are near where their distance says so, whichever comes first and however they are moved", "[mesh]") {
    int near = 0;
    for (std::uint64_t n = 0; n < 400; ++n) {
        RandomStream random(11, n);
        const auto point = [&](double size) {
            return Eigen::Vector3d(size * random.uniform(), size * random.uniform(), size * random.uniform());
        };
        const Eigen::Vector3d low_a = point(3), low_b = point(6), shift = point(2);
        const Eigen::AlignedBox3d a(low_a, low_a + point(3)), b(low_b, low_b + point(3));
        const Mesh first = box(a.min(), a.max()), second = box(b.min() - shift, b.max() - shift);
        const double mm = 0.05 + random.uniform();
        const bool wanted = distance(a, b) < mm;
        CAPTURE(n, mm, distance(a, b));
        CHECK(nearer_than(first.tree(), second.tree(), shift, mm) == wanted);
        CHECK(nearer_than(second.tree(), first.tree(), -shift, mm) == wanted);
        near += wanted;
    }
    CHECK(near > 50);
    CHECK(near < 350);
}

TEST_CASE("A body deep inside another is near it, one in its cavity is not", "[mesh]") {
    const Mesh outer = box({0, 0, 0}, {20, 20, 20}), inner = box({9, 9, 9}, {11, 11, 11});
    CHECK(nearer_than(outer.tree(), inner.tree(), Eigen::Vector3d::Zero(), 1));
    CHECK(nearer_than(inner.tree(), outer.tree(), Eigen::Vector3d::Zero(), 1));
    Mesh hollow = outer;
    for (const auto& [a, b, c] : box({5, 5, 5}, {15, 15, 15}).triangles)
        hollow.triangles.push_back({a + 8, c + 8, b + 8});
    for (const Eigen::Vector3d& p : box({5, 5, 5}, {15, 15, 15}).positions) hollow.positions.push_back(p);
    CHECK_FALSE(nearer_than(hollow.tree(), inner.tree(), Eigen::Vector3d::Zero(), 1));
    CHECK(nearer_than(hollow.tree(), inner.tree(), Eigen::Vector3d::Zero(), 4.5));
}

TEST_CASE("Edges that cross at a distance, and ends, are as far apart as sampling says", "[mesh]") {
    for (std::uint64_t n = 0; n < 100; ++n) {
        RandomStream random(12, n);
        const auto point = [&] {
            return Eigen::Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        };
        const Eigen::Vector3d p0 = point(), p1 = point(), q0 = point(), q1 = n % 10 == 0 ? q0 : point();
        double least = 1e9;
        for (int i = 0; i <= 200; ++i)
            for (int j = 0; j <= 200; ++j)
                least = std::min(least, (p0 + i / 200.0 * (p1 - p0) - q0 - j / 200.0 * (q1 - q0)).norm());
        const double found = std::sqrt(squared_segment_distance(p0, p1, q0, q1));
        CHECK(found <= least + 1e-12);
        CHECK(found > least - 0.01);  // the samples are 0.0087 apart at most
    }
}
