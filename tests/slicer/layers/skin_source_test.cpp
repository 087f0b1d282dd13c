// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/skin_source.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "optics/layered/shell_appearance.h"
#include "tests/slicer/layers/made_voxels.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using voxtone::test::made_voxels;
using voxtone::test::MadeVoxels;

namespace {

constexpr std::array<double, 3> pitch_mm{25.4 / 600, 25.4 / 300, 0.027};

/// The upper face of a box, as two triangles.
VisibleSurface top_of(const Vector3d& size_mm) {
    VisibleSurface top;
    top.positions_mm = {{0, 0, size_mm.z()}, {size_mm.x(), 0, size_mm.z()}, size_mm, {0, size_mm.y(), size_mm.z()}};
    top.triangles = {{0, 1, 2}, {0, 2, 3}};
    top.source_triangle = {0, 1};
    top.source_uv.assign(2, {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    return top;
}

/// Cells of 2 x 1 x 3 voxels at these places of the grid of cells.
optics::Surface cells_at(const std::vector<std::array<std::int32_t, 3>>& places) {
    optics::Surface surface;
    surface.cell_voxels = {2, 1, 3};
    for (const auto& place : places) {
        optics::SurfaceCell& cell = surface.cells.emplace_back();
        cell.cell = place;
        for (std::size_t a = 0; a < 3; ++a)
            cell.centre_mm[a] = float((place[a] + 0.5) * surface.cell_voxels[a] * pitch_mm[a]);
    }
    return surface;
}

}  // namespace

TEST_CASE("A layer of the skin begins at the border of the one above it, and core at the last") {
    const VisibleSurface top = top_of({0.5, 0.5, 1});
    const SurfacePlaces places(top, Vector3d::Zero());
    const CellIndex cells(cells_at({{0, 0, 12}, {5, 5, 12}}), pitch_mm);
    // Borders that floats hold exactly.
    const halftone::SkinLayers layers{{0.125, 0.25, 0.5, 1}};
    const SkinMap map{places, cells, layers};
    for (const bool far : {false, true}) {
        CAPTURE(far);
        const float u = 0.05f, v = far ? 0.9f : 0.05f;
        const std::size_t first = far ? 4 : 0;
        CHECK(map.at(0, u, v, 0) == first);
        for (std::size_t l = 0; l < 4; ++l) {
            CAPTURE(l);
            const auto border = float(layers.bottom_mm[l]);
            CHECK(map.at(0, u, v, std::nextafter(border, 0.0f)) == first + l);
            CHECK(map.at(0, u, v, border) == (l == 3 ? SkinMap::core : first + l + 1));
            CHECK(map.at(0, u, v, std::nextafter(border, 2.0f)) == (l == 3 ? SkinMap::core : first + l + 1));
        }
    }
}

TEST_CASE("Layers of the skin lie in the print as deep as they say, to the voxel's centre") {
    // One resin for each layer, and core below them, on a slab whose upper face alone is coloured.
    VoxelGrid grid;
    grid.pitch_mm = {pitch_mm[0], pitch_mm[1], pitch_mm[2]};
    grid.size = {12, 8, 20};
    const Vector3d size_mm = grid.pitch_mm.cwiseProduct(Vector3d(12, 8, 20));
    const VisibleSurface top = top_of(size_mm);
    const SurfaceIndex index(top);
    const SurfaceShell shell(index, grid, 0.5);
    const Solid solid(shapes::box(Vector3d::Zero(), size_mm), grid);
    io::TexturedMesh textured;
    textured.positions = top.positions_mm;
    textured.triangles = top.triangles;
    textured.material_of_triangle = {0, 0};
    textured.materials.emplace_back();
    textured.materials[0].rgb.setConstant(0.3f);  // unlike the core
    const SurfaceColour colour(textured, pitch_mm[0]);

    const optics::ResinSet set = optics::vero_opaque().subset(std::vector<std::string>{"C", "M", "Y", "W"});
    optics::ShellGeometry geometry;
    geometry.core_resin = set.find("W");
    const optics::ShellAppearance appearance(set, geometry);
    halftone::SeparationOptions options;
    options.nodes = 2;
    const halftone::Separation separation(appearance, options);
    const halftone::BlueNoiseScreen screen(pitch_mm);

    const SurfacePlaces places(top, Vector3d::Zero());
    const CellIndex cells(cells_at({{2, 3, 6}}), pitch_mm);
    const halftone::SkinLayers layers{{0.04, 0.1, 0.33}};
    halftone::SkinMixtures mixtures(1, 3, 4);
    for (std::size_t l = 0; l < 3; ++l) mixtures.cell(0)[4 * l + l] = 1;
    const SkinSource skin({places, cells, layers}, mixtures, 3);
    const MadeVoxels made =
        made_voxels({solid, nullptr, top, shell, 4, MixtureSources{colour, separation, &screen, 1, &skin}});
    std::size_t wrong = 0;
    for (int k = 0; k < 20; ++k) {
        const double depth_mm = (20 - k - 0.5) * pitch_mm[2];  // of the voxel's centre
        const int expected = depth_mm < 0.04 ? 1 : depth_mm < 0.1 ? 2 : depth_mm < 0.33 ? 3 : 4;
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 12; ++i) wrong += made.at(i, j, k) != expected;
    }
    CHECK(wrong == 0);
    // Where the loop does not look, the separation says what is printed.
    const std::vector<char> nowhere(top.triangles.size(), 1);
    const SkinSource apart({places, cells, layers, {}, nowhere}, mixtures, 3);
    CHECK_FALSE(apart.knows(0));
    const auto printed = [&](const SkinSource* by) {
        return made_voxels({solid, nullptr, top, shell, 4, MixtureSources{colour, separation, &screen, 1, by}});
    };
    const MadeVoxels without = printed(nullptr), with = printed(&apart);
    std::size_t other = 0, looped = 0;
    for (int k = 0; k < 20; ++k)
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 12; ++i) {
                other += with.at(i, j, k) != without.at(i, j, k);
                looped += made.at(i, j, k) != without.at(i, j, k);
            }
    CHECK(other == 0);
    CHECK(looped > 0);
}

TEST_CASE("Clear resin lies over and under the colours as deep as it is asked for, whoever makes the mixtures") {
    VoxelGrid grid;
    grid.pitch_mm = {pitch_mm[0], pitch_mm[1], pitch_mm[2]};
    grid.size = {12, 8, 30};
    const Vector3d size_mm = grid.pitch_mm.cwiseProduct(Vector3d(12, 8, 30));
    const VisibleSurface top = top_of(size_mm);
    const SurfaceIndex index(top);
    const SurfaceShell shell(index, grid, 2);
    const Solid solid(shapes::box(Vector3d::Zero(), size_mm), grid);
    io::TexturedMesh textured;
    textured.positions = top.positions_mm;
    textured.triangles = top.triangles;
    textured.material_of_triangle = {0, 0};
    textured.materials.emplace_back();
    textured.materials[0].rgb.setZero();
    const SurfaceColour colour(textured, pitch_mm[0]);

    optics::ResinSet set = optics::vero_opaque().subset(std::vector<std::string>{"K", "W"});
    set.resins.push_back({"VeroClear", "T", {0, 0, 0}, {1, 1, 1}});
    optics::ShellGeometry geometry{0.25, 1, 0.2};
    geometry.clear_resin = 2, geometry.over_mm = 0.15, geometry.under_mm = 0.21;
    const optics::ShellAppearance appearance(set, geometry);
    halftone::SeparationOptions options;
    options.nodes = 2;
    const halftone::Separation separation(appearance, options);
    const halftone::BlueNoiseScreen screen(pitch_mm);
    const DepthZones zones = zones_of(geometry);

    const SurfacePlaces places(top, Vector3d::Zero());
    const CellIndex cells(cells_at({{2, 3, 9}}), pitch_mm);
    const halftone::SkinLayers layers{{0.1, 0.25}};
    halftone::SkinMixtures mixtures(1, 2, 3);
    mixtures.cell(0)[0] = mixtures.cell(0)[4] = 1;  // K over W
    const SkinSource skin({places, cells, layers, zones}, mixtures, 1);
    for (const bool by_loop : {false, true}) {
        CAPTURE(by_loop);
        LayerSources sources{solid, nullptr, top, shell, 2, MixtureSources{colour, separation, &screen, 1, nullptr}};
        if (by_loop) std::get<MixtureSources>(sources.resins).skin = &skin;
        sources.zones = zones;
        const MadeVoxels made = made_voxels(sources);
        sources.core_only = true;
        const MadeVoxels shape = made_voxels(sources);
        std::size_t wrong = 0;
        for (int k = 0; k < 30; ++k) {
            const double depth_mm = (30 - k - 0.5) * pitch_mm[2];
            const bool is_clear = depth_mm < 0.15 || depth_mm >= 0.6;
            const bool is_black = depth_mm < (by_loop ? 0.25 : 0.4);
            for (int j = 0; j < 8; ++j)
                for (int i = 0; i < 12; ++i) {
                    const io::Material voxel = made.at(i, j, k);
                    // The separation's black is nearly all of K.
                    wrong += is_black && !by_loop && !is_clear ? voxel == 3
                                                               : voxel != (is_clear   ? 3
                                                                           : is_black ? 1
                                                                                      : 2);
                    wrong += shape.at(i, j, k) != (depth_mm < 0.15 ? 0 : is_clear ? 3 : 2);
                }
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("A place on a triangle is found by its coordinates in the model, wherever these lie") {
    VisibleSurface surface;
    surface.positions_mm = {{1, 2, 3}, {4, 2, 3.5}, {1.5, 6, 2}};
    surface.triangles = {{0, 1, 2}, {0, 1, 2}};
    surface.source_triangle = {0, 1};
    // A piece of a larger triangle, and a patch that has all its colour from one place.
    surface.source_uv = {{Eigen::Vector2f(0.2f, 0.3f), Eigen::Vector2f(0.7f, 0.25f), Eigen::Vector2f(0.3f, 0.6f)},
                         {Eigen::Vector2f(0.5f, 0.5f), Eigen::Vector2f(0.5f, 0.5f), Eigen::Vector2f(0.5f, 0.5f)}};
    const Vector3d corner(0.5, 0.25, 1);
    const SurfacePlaces places(surface, corner);
    for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector2f uv = surface.source_uv[0][k];
        CHECK((places.at(0, uv.x(), uv.y()).cast<double>() - (surface.positions_mm[k] - corner)).norm() < 1e-5);
    }
    const Vector3d middle = (surface.positions_mm[0] + surface.positions_mm[1] + surface.positions_mm[2]) / 3 - corner;
    CHECK((places.at(1, 0.5f, 0.5f).cast<double>() - middle).norm() < 1e-5);
}
