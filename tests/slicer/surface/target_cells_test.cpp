// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>

#include "slicer/surface/target_cells.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

/// Cells of these areas and nothing else.
optics::Surface cells_of(const std::vector<float>& areas) {
    optics::Surface surface;
    for (const float area : areas) {
        optics::SurfaceCell cell;
        cell.area_mm2 = area;
        surface.cells.push_back(cell);
    }
    return surface;
}

}  // namespace

TEST_CASE("The target of a cell is the mean colour of the surface next to it, on every side of a body") {
    // A box whose six sides have a colour each.
    const std::array<int, 3> size{48, 24, 60};
    const Eigen::Vector3d corner(3, 4, 5), extent(size[0] * j750[0], size[1] * j750[1], size[2] * j750[2]);
    const SolidMesh left = shapes::box(corner, corner + extent);
    io::TexturedMesh mesh;
    mesh.positions = left.positions_mm;
    // The box of shapes.h: two triangles each of bottom, top, front, back, left, right.
    const std::array<Eigen::Vector3f, 6> side{Eigen::Vector3f{0.1f, 0.1f, 0.1f},
                                              {0.8f, 0.1f, 0.1f},
                                              {0.2f, 0.2f, 0.8f},
                                              {0.8f, 0.8f, 0.1f},
                                              {0.1f, 0.8f, 0.8f},
                                              {0.8f, 0.1f, 0.8f}};
    VisibleSurface surface;
    surface.positions_mm = mesh.positions;
    for (std::uint32_t t = 0; t < 12; ++t) {
        mesh.triangles.push_back(left.triangles[t]);
        mesh.material_of_triangle.push_back(t / 2);
        surface.triangles.push_back(left.triangles[t]);
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    mesh.materials.resize(6);
    for (std::size_t m = 0; m < 6; ++m) mesh.materials[m].rgb = side[m];

    const optics::ResinVolume volume = optics::make_resin_volume(size, j750, [](int, int, int) { return 1; });
    const optics::Surface cells = optics::find_surface({&volume, nullptr}, {2, 1, 3}, optics::SurfacePart::all);
    const auto target = target_of_cells(cells, j750, corner, SurfaceIndex(surface), mesh, nullptr);
    // Facing -x, +x, -y, +y, -z, +z: left, right, front, back, bottom, top.
    const std::array<std::size_t, 6> side_of_facing{4, 5, 2, 3, 0, 1};
    std::size_t wrong = 0, edges = 0;
    for (std::size_t c = 0; c < cells.cells.size(); ++c) {
        const auto first = cells.faces.begin() + cells.cells[c].first_face, last = first + cells.cells[c].faces;
        Eigen::Vector3f mean = Eigen::Vector3f::Zero();
        for (auto face = first; face != last; ++face)
            mean += side[side_of_facing[static_cast<std::size_t>(face->facing)]];
        mean /= static_cast<float>(cells.cells[c].faces);
        const bool one_side =
            std::all_of(first, last, [&](const optics::SurfaceFace& f) { return f.facing == first->facing; });
        edges += !one_side;
        // At an edge the points that are asked for are some of the faces': between the colours of its sides.
        wrong += one_side ? (target[c] - mean).norm() > 1e-5f : (target[c] - mean).norm() > 0.5f;
    }
    CHECK(wrong == 0);
    CHECK(edges > 100);
}

TEST_CASE("Differences are counted by area") {
    const optics::Surface cells = cells_of({1, 6, 2, 1});
    const std::vector<double> differences{8, 1, 3, 0.25};
    const optics::DifferenceSummary summary = summarize_by_area(cells, differences);
    CHECK(summary.count == 4);
    CHECK(summary.mean == Approx((8 + 6 + 6 + 0.25) / 10));
    CHECK(summary.median == 1);
    CHECK(summary.percentile_95 == 8);
    CHECK(summary.max == 8);
    const std::vector<double> share = histogram_by_area(cells, differences, {0, 0.5, 1, 2, 5});
    CHECK(share == std::vector<double>{0.1, 0, 0.6, 0.2, 0.1});
    CHECK(summarize_by_area(cells_of({}), {}).count == 0);
}

TEST_CASE("The map of differences runs from white over yellow and red to black") {
    CHECK(difference_colour(0) == Eigen::Vector3f(1, 1, 1));
    CHECK(difference_colour(20) == Eigen::Vector3f(0, 0, 0));
    CHECK(difference_colour(1000) == Eigen::Vector3f(0, 0, 0));
    const auto luminance = [](const Eigen::Vector3f& c) { return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2]; };
    for (double d = 0; d < 20; d += 0.5) CHECK(luminance(difference_colour(d + 0.5)) < luminance(difference_colour(d)));
    CHECK(colour_differences({Eigen::Vector3f(0.2f, 0.3f, 0.4f)}, {Eigen::Vector3f(0.2f, 0.3f, 0.4f)})[0] == 0);
    CHECK(colour_differences({Eigen::Vector3f(1, 1, 1)}, {Eigen::Vector3f(0, 0, 0)})[0] == Approx(100).margin(1e-3));
}

TEST_CASE("Along a ramp of colours each cell has that of its own place") {
    const std::array<int, 3> size{24, 18, 30};
    const Eigen::Vector3d corner(1, 2, 3), extent(size[0] * j750[0], size[1] * j750[1], size[2] * j750[2]);
    const SolidMesh box = shapes::box(corner, corner + extent);
    const auto ramp = [&](const Eigen::Vector3d& p) -> Eigen::Vector3f {
        return (p - corner).cwiseQuotient(extent).cast<float>();
    };
    io::TexturedMesh mesh;
    mesh.positions = box.positions_mm;
    mesh.triangles = box.triangles;
    mesh.materials.resize(1);
    mesh.material_of_triangle.assign(12, 0);
    VisibleSurface surface;
    surface.positions_mm = mesh.positions;
    surface.triangles = mesh.triangles;
    for (std::uint32_t t = 0; t < 12; ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        mesh.corner_rgb.push_back({ramp(mesh.positions[a]), ramp(mesh.positions[b]), ramp(mesh.positions[c])});
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    const optics::ResinVolume volume = optics::make_resin_volume(size, j750, [](int, int, int) { return 1; });
    const optics::Surface cells = optics::find_surface({&volume, nullptr}, {2, 1, 3}, optics::SurfacePart::all);
    const auto target = target_of_cells(cells, j750, corner, SurfaceIndex(surface), mesh, nullptr);
    std::size_t flat = 0;
    double most = 0;
    for (std::size_t c = 0; c < cells.cells.size(); ++c) {
        const auto first = cells.faces.begin() + cells.cells[c].first_face, last = first + cells.cells[c].faces;
        if (!std::all_of(first, last, [&](const optics::SurfaceFace& f) { return f.facing == first->facing; }))
            continue;
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (auto face = first; face != last; ++face) {
            Eigen::Vector3d p(face->voxel[0] + 0.5, face->voxel[1] + 0.5, face->voxel[2] + 0.5);
            const int facing = static_cast<int>(face->facing);
            p[facing / 2] += facing % 2 == 1 ? 0.5 : -0.5;
            middle += p / double(cells.cells[c].faces);
        }
        const Eigen::Vector3d place = corner + middle.cwiseProduct(Eigen::Vector3d(j750[0], j750[1], j750[2]));
        most = std::max(most, double((target[c] - ramp(place)).cwiseAbs().maxCoeff()));
        ++flat;
    }
    CHECK(flat > 200);
    CHECK(most < 0.5 / 18);  // half a voxel where voxels are largest
}
