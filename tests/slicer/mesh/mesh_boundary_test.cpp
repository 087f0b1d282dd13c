// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_boundary.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "optics/layered/directional.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "shapes.h"
#include "slicer/mesh/parted_sheets.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/thin_features.h"

using namespace voxtone;
using namespace voxtone::optics;
using voxtone::slicer::MeshBoundary;
using voxtone::slicer::Solid;
using voxtone::slicer::SolidMesh;
using voxtone::slicer::VoxelGrid;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

/// The mesh on the printer's grid, all of one material, and where the volume's corner lies.
struct Body {
    ResinVolume volume;
    Eigen::Vector3d corner;
    /// `thin`: with the voxels that features thinner than one need.
    Body(const SolidMesh& mesh, Material material, bool thin = false) {
        Eigen::Vector3d low = mesh.positions_mm[0], high = low;
        for (const auto& p : mesh.positions_mm) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        VoxelGrid grid;
        grid.pitch_mm = {j750[0], j750[1], j750[2]};
        grid.origin_mm = low - 0.3 * grid.pitch_mm;
        for (int a = 0; a < 3; ++a)
            grid.size[static_cast<std::size_t>(a)] =
                static_cast<int>(std::ceil((high - grid.origin_mm)[a] / grid.pitch_mm[a]));
        corner = grid.origin_mm;
        const Solid solid(mesh, grid);
        voxtone::slicer::SpanSlab spans = solid.slab(0, grid.size[2]);
        if (thin) {
            const voxtone::slicer::SolidIndex index(mesh);
            (void)voxtone::slicer::ThinFeatures(index, solid).slab(0, grid.size[2], spans);
        }
        ResinVolumeBuilder builder(grid.size, j750);
        std::vector<Material> layer(static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]));
        for (int k = 0; k < grid.size[2]; ++k) {
            std::fill(layer.begin(), layer.end(), air);
            for (int j = 0; j < grid.size[1]; ++j)
                for (const auto& span : spans.row(j, k))
                    for (int i = span.begin; i < span.end; ++i)
                        layer[static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.size[0]) +
                              static_cast<std::size_t>(i)] = material;
            builder.add_layer(layer);
        }
        volume = builder.finish();
    }
};

double length(const Point& p) { return std::hypot(p[0], p[1], p[2]); }

}  // namespace

TEST_CASE("A fine mesh of a sphere is the sphere to light") {
    const SolidMesh mesh = shapes::sphere(1.2, 100);
    const MeshBoundary boundary(mesh.positions_mm, mesh.triangles, {-1.35, -1.35, -1.35});
    const Sphere sphere({1.35, 1.35, 1.35}, 1.2);
    RandomStream random(1, 2);
    double worst_distance = 0, worst_normal = 0, worst_place = 0;
    for (int i = 0; i < 20000; ++i) {
        Point from{}, d{};
        do
            for (double& x : from) x = 2.7 * random.uniform();
        while (std::hypot(from[0] - 1.35, from[1] - 1.35, from[2] - 1.35) > 1.19);
        do
            for (double& x : d) x = 2 * random.uniform() - 1;
        while (length(d) > 1 || length(d) < 0.1);
        const double l = length(d);
        for (double& x : d) x /= l;
        double t = 0, exact = 0;
        BoundaryNormals n, exact_n;
        REQUIRE(boundary.leaves(from, d, 10, t, n));
        REQUIRE(sphere.leaves(from, d, 10, exact, exact_n));
        REQUIRE_FALSE(boundary.leaves(from, d, 0.95 * t, exact, exact_n));
        (void)sphere.leaves(from, d, 10, exact, exact_n);
        Point gap{};
        for (std::size_t a = 0; a < 3; ++a) gap[a] = n.shading[a] - exact_n.shading[a];
        // Across a flat facet by the sagitta, as seen along the ray.
        const double facing = d[0] * exact_n.shading[0] + d[1] * exact_n.shading[1] + d[2] * exact_n.shading[2];
        worst_distance = std::max(worst_distance, std::abs(t - exact) * facing);
        worst_normal = std::max(worst_normal, length(gap));
        BoundaryNormals nearest_n;
        const Point near = boundary.nearest(from, nearest_n);
        worst_place = std::max(worst_place, std::abs(std::hypot(near[0] - 1.35, near[1] - 1.35, near[2] - 1.35) - 1.2));
        REQUIRE(
            boundary.comes_within(from, 1.001 * std::hypot(near[0] - from[0], near[1] - from[1], near[2] - from[2])));
        REQUIRE_FALSE(
            boundary.comes_within(from, 0.999 * std::hypot(near[0] - from[0], near[1] - from[1], near[2] - from[2])));
    }
    const double step = M_PI / 100;  // angle between vertices
    INFO(worst_distance << " " << worst_normal << " " << worst_place);
    CHECK(worst_distance < 1.2 * step * step / 4);  // sagitta of a facet's diagonal
    CHECK(worst_place < 1.2 * step * step / 4);
    CHECK(worst_normal < step / 4);
}

TEST_CASE("Edges of a box stay sharp, a start outside goes back in") {
    const SolidMesh mesh = shapes::box({0, 0, 0}, {2, 1, 1});
    const MeshBoundary boundary(mesh.positions_mm, mesh.triangles, {0, 0, 0});
    double t = 0;
    BoundaryNormals n;
    REQUIRE(boundary.leaves({1.9999, 0.9998, 0.5}, {1, 0, 0}, 1, t, n));
    CHECK(n.shading == Point{1, 0, 0});
    CHECK(n.geometric == Point{1, 0, 0});
    REQUIRE(boundary.leaves({-0.01, 0.5, 0.4}, {1, 0, 0}, 3, t, n));
    CHECK(t == Approx(2.01));
    CHECK_FALSE(boundary.leaves({0.5, 0.5, 0.4}, {1, 0, 0}, 1.4, t, n));
}

TEST_CASE("White furnace within meshes: coarse, sharp, thin and curved") {
    ResinSet set;
    set.name = "test";
    set.channels.wavelengths_nm = {550};
    set.resins = {{"white", "W", {5}, {1}}};
    const auto tilted = [](SolidMesh mesh) { return shapes::moved(std::move(mesh), shapes::tilt()); };
    for (const SolidMesh& mesh : {shapes::sphere(0.8, 5), tilted(shapes::box({0, 0, 0}, {1.5, 1, 0.2})),
                                  tilted(shapes::torus(0.7, 0.25, 24, 10))}) {
        const Body body(mesh, 1);
        const MeshBoundary boundary(mesh.positions_mm, mesh.triangles, body.corner);
        const Scene scene{&body.volume, &set, Backing::none, Sides::open};
        const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
        const Appearance seen = MonteCarlo({.paths = 20, .boundary = &boundary}).predict(scene, surface);
        for (const float value : seen.value) REQUIRE(value == 1.0f);
    }
}

TEST_CASE("A tilted plate of mesh looks as the flat one, on either side of the edge") {
    // A plate of 6 x 6 x 0.5 mm; where it is seen, 2 mm from its edges, they are not felt in yellow's blue channel and
    // little in the others: compared with the same plate untilted, with the faces of its voxels, which are exact there.
    const ResinSet set = vero_opaque();
    const SolidMesh flat = shapes::box({0, 0, 0}, {6, 6, 0.513});
    const auto centre_of = [&](const SolidMesh& mesh, bool with_boundary, const Eigen::Affine3d& turn) {
        const Body body(mesh, 3);
        const MeshBoundary boundary(mesh.positions_mm, mesh.triangles, body.corner);
        const Scene scene{&body.volume, &set, Backing::none, Sides::open};
        Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
        // The cells within 0.6 mm of the middle of the upper side.
        const Eigen::Vector3d middle = turn * Eigen::Vector3d(3, 3, 0.513) - body.corner;
        std::vector<SurfaceCell> near;
        for (const SurfaceCell& cell : surface.cells)
            if ((Eigen::Vector3d(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]) - middle).norm() < 0.45)
                near.push_back(cell);
        surface.cells = near;
        REQUIRE(near.size() > 20);
        const Appearance seen =
            MonteCarlo({.paths = 1500, .boundary = with_boundary ? &boundary : nullptr}).predict(scene, surface);
        std::array<double, 6> mean{};  // and variance
        double area = 0;
        for (const SurfaceCell& cell : near) area += cell.area_mm2;
        for (std::size_t i = 0; i < near.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const double w = near[i].area_mm2 / area;
                mean[c] += w * seen.value[3 * i + c];
                mean[c + 3] += w * w * std::pow(seen.standard_error[3 * i + c], 2);
            }
        return mean;
    };
    const auto reference = centre_of(flat, false, Eigen::Affine3d::Identity());
    for (const double angle : {0.0, 0.35, 1.0}) {
        const Eigen::Affine3d turn(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.6, 0.8, 0).normalized()));
        const auto seen = centre_of(shapes::moved(flat, turn), true, turn);
        for (std::size_t c = 0; c < 3; ++c) {
            const double sigma = std::sqrt(seen[c + 3] + reference[c + 3]);
            INFO(angle << " " << c << ": " << seen[c] << ", flat " << reference[c] << " +- " << sigma);
            CHECK(std::abs(seen[c] - reference[c]) < 4 * sigma);
            CHECK(std::abs(1.03 * seen[c] - reference[c]) > (c == 2 ? 0 : 4) * sigma);
        }
    }
}

TEST_CASE("A sheet without a thickness looks as a slab of its voxels' thickness by adding-doubling") {
    const ResinSet set = vero_opaque();
    constexpr Material magenta = 2;
    SolidMesh flat;
    flat.positions_mm = {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}};
    flat.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
    const AngularGrid grid = angular_grid(set.eta, 16, 16);
    const AddingDoubling solver(grid, set.g, 32);
    for (const double angle : {0.3, 1.2}) {
        const Eigen::Affine3d turn(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.6, 0.8, 0).normalized()));
        const SolidMesh mesh = shapes::moved(flat, turn);
        const Body body(mesh, magenta, true);
        const Eigen::Vector3d pitch(j750[0], j750[1], j750[2]), normal = turn.linear().col(2);
        const auto parted = voxtone::slicer::part_sheets(mesh.positions_mm, mesh.triangles, pitch);
        const MeshBoundary boundary(parted.positions_mm, parted.triangles, body.corner);
        const Scene scene{&body.volume, &set, Backing::none, Sides::open};
        Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
        const Eigen::Vector3d middle = turn * Eigen::Vector3d(3, 3, 0) - body.corner;
        std::erase_if(surface.cells, [&](const SurfaceCell& cell) {
            return (Eigen::Vector3d(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]) - middle).norm() > 0.6;
        });
        REQUIRE(surface.cells.size() > 20);
        const Appearance seen = MonteCarlo({.paths = 2000, .boundary = &boundary}).predict(scene, surface);
        for (std::size_t c = 0; c < 3; ++c) {
            double mean = 0, variance = 0;
            for (std::size_t i = 0; i < surface.cells.size(); ++i) {
                mean += seen.value[3 * i + c] / double(surface.cells.size());
                variance += std::pow(seen.standard_error[3 * i + c] / double(surface.cells.size()), 2);
            }
            const LayerResponse slab =
                solver.layer(set.resins[magenta - 1].medium(c), normal.cwiseAbs().cwiseProduct(pitch).maxCoeff());
            const double wanted = appearance_of(grid, slab, Backing::none);
            INFO(angle << " " << c << ": " << mean << " +- " << std::sqrt(variance) << ", slab " << wanted);
            CHECK(std::abs(mean - wanted) < 4 * std::sqrt(variance));
        }
    }
}
