// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every answer of the tree against that of all triangles, one after the other.
#include "slicer/mesh/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "slicer/mesh/mesh_chain.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

Vector3d random_point(RandomStream& random, double low, double high) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    return Vector3d::Constant(low) + (high - low) * Vector3d(x, y, z);
}

/// Triangles of all sizes and shapes in a box of 10 mm, some without area, some in one place.
SolidMesh scattered(int count) {
    RandomStream random(5, 1);
    SolidMesh mesh;
    for (int t = 0; t < count; ++t) {
        const Vector3d at = random_point(random, 0, 10);
        const double size = std::pow(10, 2 * random.uniform() - 1.5);
        for (int c = 0; c < 3; ++c) mesh.positions_mm.push_back(at + size * random_point(random, -1, 1));
        const auto v = static_cast<std::uint32_t>(3 * t);
        mesh.triangles.push_back(t % 10 == 3 ? Triangle{v, v, v + 1} : Triangle{v, v + 1, v + 2});
        if (t % 7 == 1 && t > 7) mesh.triangles.back() = mesh.triangles[std::size_t(t) - 1];
    }
    return mesh;
}

/// The least distance of p from a triangle, by sampling it finer and finer around the best place.
double sampled_distance(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    double best = 1e300, u0 = 0, v0 = 0, width = 1;
    for (int round = 0; round < 12; ++round, width /= 3) {
        double best_u = u0, best_v = v0;
        for (int i = -10; i <= 10; ++i)
            for (int j = -10; j <= 10; ++j) {
                const double u = std::clamp(u0 + width * i / 10, 0.0, 1.0);
                const double v = std::clamp(v0 + width * j / 10, 0.0, 1 - u);
                const double d = (a + u * (b - a) + v * (c - a) - p).norm();
                if (d < best) best = d, best_u = u, best_v = v;
            }
        u0 = best_u, v0 = best_v;
    }
    return best;
}

struct Found {
    std::uint32_t triangle;
    double distance;
};
Found nearest_of_all(const SolidMesh& mesh, const Vector3d& p) {
    Found best{TriangleTree::none, 1e300};
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vector3d &pa = mesh.positions_mm[a], &pb = mesh.positions_mm[b], &pc = mesh.positions_mm[c];
        const Vector3d w = nearest_weights(p, pa, pb, pc);
        const double d = (w[0] * pa + w[1] * pb + w[2] * pc - p).norm();
        if (d < best.distance) best = {t, d};
    }
    return best;
}

/// Whether boxes [low, high] of two things meet.
bool meet(const Vector3d& low, const Vector3d& high, const Vector3d& other_low, const Vector3d& other_high) {
    return (low.array() <= other_high.array()).all() && (high.array() >= other_low.array()).all();
}

std::pair<Vector3d, Vector3d> box_of(const SolidMesh& mesh, std::uint32_t t) {
    Vector3d low = mesh.positions_mm[mesh.triangles[t][0]], high = low;
    for (const std::uint32_t v : mesh.triangles[t])
        low = low.cwiseMin(mesh.positions_mm[v]), high = high.cwiseMax(mesh.positions_mm[v]);
    return {low, high};
}

}  // namespace

TEST_CASE("The nearest point of a triangle is on its face, an edge or a corner") {
    RandomStream random(3, 2);
    for (int round = 0; round < 300; ++round) {
        const Vector3d a = random_point(random, 0, 1), b = random_point(random, 0, 1);
        Vector3d c = random_point(random, 0, 1);
        if (round % 5 == 0) c = a + 0.3 * (b - a);  // no area
        if (round % 25 == 0) c = a;
        const Vector3d p = random_point(random, -1, 2);
        const Vector3d w = nearest_weights(p, a, b, c);
        CHECK(w.minCoeff() >= 0);
        CHECK(w.sum() == Approx(1));
        CHECK((w[0] * a + w[1] * b + w[2] * c - p).norm() ==
              Approx(sampled_distance(p, a, b, c)).epsilon(1e-4).margin(1e-6));
    }
    const Vector3d point(1, 2, 3);
    CHECK(nearest_weights({0, 0, 0}, point, point, point) == Vector3d(1, 0, 0));
}

TEST_CASE("A tree finds the nearest triangle, and the lowest of several") {
    const SolidMesh mesh = scattered(400);
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    CHECK_FALSE(tree.empty());
    RandomStream random(9, 1);
    for (int round = 0; round < 400; ++round) {
        const Vector3d p = random_point(random, -5, 15);
        const Found wanted = nearest_of_all(mesh, p);
        const auto found = tree.nearest(p);
        CHECK(found.triangle == wanted.triangle);
        CHECK(found.distance == Approx(wanted.distance));
        CHECK((found.point - p).norm() == Approx(wanted.distance));
        // A guess changes nothing.
        const auto guess = static_cast<std::uint32_t>(random.uniform() * 400);
        CHECK(tree.nearest(p, guess).triangle == wanted.triangle);
        // Nor does a limit that it lies within; beyond there is nothing.
        CHECK(tree.nearest(p, TriangleTree::none, wanted.distance * 1.001).triangle == wanted.triangle);
        CHECK(tree.nearest(p, TriangleTree::none, wanted.distance * 0.999).triangle == TriangleTree::none);
    }
    // Of many in one place the first.
    const std::vector<Vector3d> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<Triangle> same(9, Triangle{0, 1, 2});
    const TriangleTree pile(positions, same);
    CHECK(pile.nearest({0.2, 0.2, 1}).triangle == 0);
    CHECK(pile.nearest({0.2, 0.2, 1}, 7).triangle == 0);
    CHECK(pile.nearest({0.2, 0.2, 1}).distance == 1);
    CHECK(TriangleTree({}, {}).nearest({0, 0, 0}).triangle == TriangleTree::none);
    CHECK(TriangleTree({}, {}).empty());
}

TEST_CASE("A tree finds every triangle whose box meets a box, and few besides") {
    const SolidMesh mesh = scattered(400);
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    RandomStream random(10, 1);
    const Vector3d slack = Vector3d::Constant(1e-4);  // of rounding to floats
    for (int round = 0; round < 200; ++round) {
        const Vector3d p = random_point(random, -2, 12), q = p + random_point(random, 0, round % 2 ? 3.0 : 0.1);
        std::vector<std::uint32_t> found{77};
        tree.overlapping(p, q, found);
        CHECK(found.front() == 77);  // it appends
        const std::set<std::uint32_t> all(found.begin() + 1, found.end());
        CHECK(all.size() == found.size() - 1);
        bool right = true;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto [low, high] = box_of(mesh, t);
            if (meet(p, q, low, high)) right = right && all.contains(t);
            if (!meet(p - slack, q + slack, low, high)) right = right && !all.contains(t);
        }
        CHECK(right);
    }
    std::vector<std::uint32_t> none;
    TriangleTree({}, {}).overlapping({0, 0, 0}, {1, 1, 1}, none);
    CHECK(none.empty());
}

TEST_CASE("Candidates of a box hold the nearest triangle of each of its points, and are not all there are") {
    const SolidMesh mesh = scattered(400);
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    RandomStream random(12, 1);
    std::size_t candidates = 0;
    for (int round = 0; round < 100; ++round) {
        const Vector3d low = random_point(random, -2, 11), high = low + random_point(random, 0, 1);
        const Vector3d q = tree.nearest((low + high) / 2).point;
        std::vector<std::uint32_t> found;
        tree.nearest_candidates(low, high, q, found);
        const std::set<std::uint32_t> all(found.begin(), found.end());
        CHECK(all.size() == found.size());
        candidates += all.size();
        bool holds = true;
        for (int n = 0; n < 30; ++n) {
            const Vector3d p = low + random_point(random, 0, 1).cwiseProduct(high - low);
            holds = holds && all.contains(nearest_of_all(mesh, p).triangle);
        }
        CHECK(holds);
        // Those whose box comes no nearer to any corner than q does are no candidates.
        bool needed = true;
        for (const std::uint32_t t : found) {
            const auto [box_low, box_high] = box_of(mesh, t);
            bool nearer = false;
            for (int v = 0; v < 8; ++v) {
                const Vector3d corner(v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
                const double distance = (corner.cwiseMax(box_low).cwiseMin(box_high) - corner).norm();
                nearer = nearer || distance <= (corner - q).norm() * (1 + 1e-4) + 2e-3;
            }
            needed = needed && nearer;
        }
        CHECK(needed);
    }
    CHECK(candidates < 100 * mesh.triangles.size() / 4);
}
