// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/surface_shell.h"

#include <map>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "slicer/mesh/triangle_tree.h"
#include "slicer/solid/solid.h"
#include "slicer/surface/shell_kernel.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

VisibleSurface all_of(const SolidMesh& mesh) {
    VisibleSurface s;
    s.positions_mm = mesh.positions_mm;
    s.triangles = mesh.triangles;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        s.source_triangle.push_back(t);
        s.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    return s;
}

struct Found {
    float distance, u, v;
    std::uint32_t triangle;
    friend bool operator==(const Found&, const Found&) = default;
};
using FoundVoxels = std::map<std::array<int, 3>, Found>;

void collect(const SurfaceShell& shell, int bk, const SpanSlab& body, FoundVoxels& out) {
    for (int bj = 0; bj < shell.block_rows(); ++bj)
        shell.for_each_block(bj, bk, body, [&](const ShellBlock& b) {
            for (int r = 0; r < b.size[1] * b.size[2]; ++r)
                for (int l = 0; l < 8; ++l) {
                    if (!(b.shell[r] >> l & 1)) continue;
                    const std::array<int, 3> voxel{b.origin[0] + l, b.origin[1] + r % b.size[1],
                                                   b.origin[2] + r / b.size[1]};
                    const int n = r * 8 + l;
                    REQUIRE(out.emplace(voxel, Found{b.distance_mm[n], b.u[n], b.v[n], b.triangle[n]}).second);
                }
        });
}

FoundVoxels collect_all(const SurfaceShell& shell, const Solid& solid) {
    FoundVoxels out;
    for (int bk = 0; bk < shell.block_layers(); ++bk) {
        const int k = bk * shell.block_size()[2];
        collect(shell, bk, solid.slab(k, std::min(k + shell.block_size()[2], solid.grid().size[2])), out);
    }
    return out;
}

double distance_to(const VisibleSurface& s, std::uint32_t t, const Vector3d& p) {
    const auto& [a, b, c] = s.triangles[t];
    const Vector3d w = nearest_weights(p, s.positions_mm[a], s.positions_mm[b], s.positions_mm[c]);
    return (w[0] * s.positions_mm[a] + w[1] * s.positions_mm[b] + w[2] * s.positions_mm[c] - p).norm();
}

// Every voxel of the body against every triangle.
void check_against_all(const VisibleSurface& surface, const Solid& solid, double depth) {
    const VoxelGrid& grid = solid.grid();
    const SurfaceIndex index(surface);
    const SurfaceShell shell(index, grid, depth);
    const FoundVoxels found = collect_all(shell, solid);
    const SpanSlab body = solid.slab(0, grid.size[2]);
    std::size_t expected = 0;
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (const Span& span : body.row(j, k))
                for (int i = span.begin; i < span.end; ++i) {
                    const Vector3d p = grid.centre(i, j, k);
                    double least = 1e30;
                    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
                        least = std::min(least, distance_to(surface, t, p));
                    const double tolerance = 1e-6 + 1e-6 * least;
                    const auto it = found.find({i, j, k});
                    CAPTURE(i, j, k, least);
                    if (std::abs(least - depth) > tolerance) REQUIRE((it != found.end()) == (least < depth));
                    if (it == found.end()) continue;
                    ++expected;
                    const Found& f = it->second;
                    REQUIRE(std::abs(f.distance - least) <= tolerance);
                    // The triangle is a nearest one, up to the tie tolerance on the square.
                    const double own = distance_to(surface, f.triangle, p);
                    REQUIRE(own * own <= least * least * (1 + 5e-6) + 3e-8);
                    // (u, v) is the place: as far away as the triangle is.
                    const auto& [a, b, c] = surface.triangles[f.triangle];
                    const Vector3d& start = surface.positions_mm[a];
                    const Vector3d place = start + double(f.u) * (surface.positions_mm[b] - start) +
                                           double(f.v) * (surface.positions_mm[c] - start);
                    REQUIRE((place - p).norm() <= own + 1e-4);
                    REQUIRE(f.u >= 0);
                    REQUIRE(f.v >= 0);
                    REQUIRE(f.u + f.v <= 1 + 1e-5);
                }
    CHECK(expected == found.size());
    CHECK(expected > 100);
}

VoxelGrid grid_around(const SolidMesh& mesh, const Vector3d& pitch) {
    Vector3d low = mesh.positions_mm[0], high = low;
    for (const Vector3d& p : mesh.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
    VoxelGrid grid;
    grid.pitch_mm = pitch;
    grid.origin_mm = low - 0.4 * pitch;
    for (int a = 0; a < 3; ++a) grid.size[a] = int(std::ceil((high[a] - grid.origin_mm[a]) / pitch[a])) + 1;
    return grid;
}

const Vector3d j750(0.0423333, 0.0846667, 0.027);

}  // namespace

TEST_CASE("Shell voxels have the nearest point of all triangles", "[slow]") {
    SECTION("torus, deeper than its tube and not") {
        const SolidMesh mesh = shapes::moved(shapes::torus(0.6, 0.25, 24, 10), shapes::tilt());
        for (double depth : {0.08, 0.15, 1.0})
            check_against_all(all_of(mesh), Solid(mesh, grid_around(mesh, j750)), depth);
    }
    SECTION("box with large triangles") {
        const SolidMesh mesh = shapes::moved(shapes::box({-0.8, -0.5, -0.6}, {0.8, 0.5, 0.6}), shapes::tilt());
        check_against_all(all_of(mesh), Solid(mesh, grid_around(mesh, j750)), 0.3);
    }
    SECTION("aligned box: whole planes of ties") {
        const SolidMesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
        check_against_all(all_of(mesh), Solid(mesh, grid_around(mesh, {0.05, 0.05, 0.05})), 1);
    }
    SECTION("dense mesh in wide voxels") {
        const SolidMesh mesh = shapes::sphere(1.2, 30);
        check_against_all(all_of(mesh), Solid(mesh, grid_around(mesh, {0.1, 0.12, 0.3})), 0.7);
    }
}

TEST_CASE("Random triangles, slivers, segments and points among them", "[slow]") {
    for (std::uint64_t round = 0; round < 4; ++round) {
        RandomStream random(5, round);
        const auto point = [&] { return Vector3d(random.uniform(), random.uniform(), random.uniform()); };
        VisibleSurface s;
        for (std::uint32_t t = 0; t < 60; ++t) {
            const Vector3d a = point(), b = a + 0.3 * (point() - point());
            Vector3d c = a + 0.3 * (point() - point());
            const double along = 1.4 * random.uniform() - 0.2;
            if (t % 6 == 1) c = a + along * (b - a) + 1e-5 * (point() - point());   // sliver
            if (t % 6 == 2) c = a + along * (b - a) + 1e-10 * (point() - point());  // flatter than its own rounding
            if (t % 6 == 3) c = a + along * (b - a);
            if (t % 6 == 4) c = b;
            const std::array corners{a, b, t % 6 == 5 && t % 4 == 1 ? a : c};
            for (const Vector3d& p : corners) s.positions_mm.push_back(t % 6 == 5 ? a : p);
            s.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
            s.source_triangle.push_back(t);
            s.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
        }
        VoxelGrid grid;
        grid.pitch_mm = {0.035, 0.05, 0.03};
        grid.size = {30, 20, 33};
        check_against_all(s, Solid(shapes::box({-1, -1, -1}, {2, 2, 2}), grid), 0.15);
    }
}

TEST_CASE("The shell of a slab with one coloured face is measured from that face alone") {
    const SolidMesh mesh = shapes::box({0, 0, 0}, {4, 3, 2});
    VisibleSurface top = all_of(mesh);
    top.triangles = {mesh.triangles[2], mesh.triangles[3]};
    top.source_triangle = {0, 1};
    top.source_uv.resize(2);
    VoxelGrid grid;
    grid.pitch_mm = {0.1, 0.1, 0.1};
    grid.size = {40, 30, 20};
    const Solid solid(mesh, grid);
    const SurfaceIndex index(top);
    const FoundVoxels found = collect_all(SurfaceShell(index, grid, 1.0), solid);
    CHECK(found.size() == 40 * 30 * 10);
    for (const auto& [voxel, f] : found) {
        REQUIRE(voxel[2] >= 10);
        REQUIRE(std::abs(f.distance - (2 - grid.centre(0, 0, voxel[2])[2])) < 1e-6);
    }
}

TEST_CASE("Shell results do not depend on the walk, the slabs or the instruction set", "[slow]") {
    const SolidMesh mesh = shapes::moved(shapes::torus(1.3, 0.6, 40, 20), shapes::tilt());
    const SurfaceIndex surface(all_of(mesh));
    const VoxelGrid grid = grid_around(mesh, j750);
    const Solid solid(mesh, grid);
    const SurfaceShell shell(surface, grid, 0.4);
    const FoundVoxels whole = collect_all(shell, solid);
    CHECK(whole.size() > 10000);

    // One layer at a time: other blocks are empty, so the walk differs.
    FoundVoxels layers;
    for (int k = 0; k < grid.size[2]; ++k) collect(shell, k / shell.block_size()[2], solid.slab(k, k + 1), layers);
    CHECK(layers == whole);

    CHECK(shell_kernel::instruction_sets() >= 1);
    for (int set = 0; set < shell_kernel::instruction_sets(); ++set) {
        shell_kernel::choose_instruction_set(set);
        CHECK(collect_all(shell, solid) == whole);
    }
    shell_kernel::choose_instruction_set(-1);
}

TEST_CASE("The tree finds the nearest point and loses no candidate") {
    RandomStream random(8, 1);
    const auto point = [&] { return Vector3d(random.uniform(), random.uniform(), random.uniform()); };
    std::vector<Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t t = 0; t < 500; ++t) {
        const Vector3d a = 10 * point();
        for (int c = 0; c < 3; ++c) positions.push_back(a + (t % 10 ? 0.5 : 5) * point());
        triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const TriangleTree tree(positions, triangles);
    const auto distance = [&](std::uint32_t t, const Vector3d& p) {
        const auto [a, b, c] = tree.corners(t);
        const Vector3d w = nearest_weights(p, a, b, c);
        return (w[0] * a + w[1] * b + w[2] * c - p).norm();
    };
    for (int n = 0; n < 200; ++n) {
        const Vector3d p = 14 * point() - Vector3d(2, 2, 2);
        double least = 1e30;
        for (std::uint32_t t = 0; t < 500; ++t) least = std::min(least, distance(t, p));
        const auto nearest = tree.nearest(p);
        REQUIRE(nearest.distance == Approx(least).epsilon(1e-12));
        REQUIRE(tree.nearest(p, std::uint32_t(n)).triangle == nearest.triangle);
        REQUIRE(tree.nearest(p, TriangleTree::none, least * 0.99).triangle == TriangleTree::none);

        const Vector3d half = 0.4 * point();
        std::vector<std::uint32_t> candidates;
        tree.nearest_candidates(p - half, p + half, nearest.point, candidates);
        for (int m = 0; m < 30; ++m) {
            const Vector3d q = p + (2 * point() - Vector3d(1, 1, 1)).cwiseProduct(half);
            const std::uint32_t best = tree.nearest(q).triangle;
            REQUIRE(std::count(candidates.begin(), candidates.end(), best) == 1);
        }
    }
    CHECK(TriangleTree({}, {}).nearest({0, 0, 0}).triangle == TriangleTree::none);
}
