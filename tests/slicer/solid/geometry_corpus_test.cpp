// SPDX-License-Identifier: GPL-3.0-or-later
//
// The geometry on real models, sound and broken ones: those of examples/, and the corpus that may lie beside the tree.
#include <algorithm>
#include <filesystem>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/models/model_reader.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_repair.h"
#include "slicer/solid/thin_features.h"
#include "slicer/surface/visible_surface.h"
#include "tests/outcomes.h"
#include "tests/places.h"
#include "voxel_parts.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
namespace fs = std::filesystem;

namespace {

const fs::path examples = fs::path(test::source_dir()) / "examples/models";
const fs::path corpus = fs::path(test::source_dir()) / "../shared/models";

io::TexturedMesh read_at(const fs::path& path, double size_mm) {
    io::TexturedMesh mesh = io::read_model(path).mesh;
    Vector3d low = mesh.positions.at(0), high = low;
    for (const Vector3d& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    for (Vector3d& p : mesh.positions) p = (p - low) * (size_mm / (high - low).maxCoeff());
    return mesh;
}

VoxelGrid grid_around(const SolidMesh& mesh, const Vector3d& pitch) {
    Vector3d low = mesh.positions_mm[mesh.triangles[0][0]], high = low;
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t)
            low = low.cwiseMin(mesh.positions_mm[v]), high = high.cwiseMax(mesh.positions_mm[v]);
    VoxelGrid grid;
    grid.pitch_mm = pitch;
    grid.origin_mm = low;
    for (int a = 0; a < 3; ++a) grid.size[a] = std::max(1, int(std::ceil((high[a] - low[a]) / pitch[a])));
    return grid;
}

/// Of the triangles that lie in a plane of the grid.
double area_along_grid(const SolidMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles)
        if (const Vector3d corner = mesh.positions_mm[t[0]],
            normal = (mesh.positions_mm[t[1]] - corner).cross(mesh.positions_mm[t[2]] - corner);
            normal.cwiseAbs().maxCoeff() > (1 - 1e-6) * normal.norm())
            sum += normal.norm() / 2;
    return sum;
}

void check_body(const io::TexturedMesh& mesh) {
    RepairOptions options;
    options.pitch_mm = 0.1;
    const RepairedMesh repaired = repair_mesh(mesh, options);
    CHECK(open_edges(repaired.solid->triangles) == 0);
    CHECK(repaired.report.after.open_edges == 0);
    if (repaired.report.before.open_edges == 0) {
        CHECK(repaired.report.filled_holes == 0);
        CHECK(repaired.report.wrapped_faces == 0);
    }

    const VoxelGrid grid = grid_around(*repaired.solid, {0.1, 0.1, 0.1});
    const Solid solid(*repaired.solid, grid);
    std::uint64_t voxels = 0;
    const SpanSlab body = solid.slab(0, grid.size[2]);
    for (int k = 0; k < grid.size[2]; ++k) voxels += body.voxels_of_layer(k);
    // Plain bodies have the volume of their mesh: each voxel the surface passes is right or wrong at random,
    // and there are at most 2 area / pitch^2 of them or so. Five standard deviations. Walls along the grid are off
    // by up to half a voxel as a whole.
    const MeshDiagnosis& after = repaired.report.after;
    if (after.shells == 1 && after.crossing_pairs == 0) {
        const double error = 5 * std::sqrt(2 * after.area_mm2 / 0.01) * 0.5 * grid.voxel_volume_mm3() +
                             0.5 * 0.1 * area_along_grid(*repaired.solid);
        CHECK(std::abs(double(voxels) * grid.voxel_volume_mm3() - after.volume_mm3) < error);
    }
    SpanSlab kept;
    const std::uint64_t added = ThinFeatures(repaired.solid, solid).slab(0, grid.size[2], kept);
    CHECK(voxels + added > 0);

    const VisibleSurface surface = find_visible_surface(mesh.positions, mesh.triangles, repaired);
    REQUIRE(!surface.triangles.empty());
    double visible = 0;
    for (const auto& t : surface.triangles) visible += area(surface.positions_mm, t);
    CHECK(visible <= 1.01 * (repaired.report.before.area_mm2 + repaired.report.filled_area_mm2));
    for (const std::uint32_t source : surface.source_triangle) REQUIRE(source < mesh.triangles.size());
}

/// Names of the models in the folder that are refused; what is read becomes a body and is checked.
std::set<std::string> check_models(const fs::path& folder) {
    std::set<std::string> refused;
    std::vector<fs::path> paths;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (io::is_model_name(entry.path())) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    REQUIRE(!paths.empty());
    for (const fs::path& path : paths) {
        CAPTURE(path.string());
        try {
            check_body(read_at(path, 20));
        } catch (const InputError&) {
            refused.insert(path.filename().string());
        }
    }
    return refused;
}

}  // namespace

TEST_CASE("Every model of the examples becomes a closed body with a visible surface") {
    CHECK(check_models(examples).empty());
}

TEST_CASE("Every model of the corpus becomes a closed body with a visible surface, or is refused") {
    if (!fs::exists(corpus)) return test::skip("the model corpus is not beside the tree");
    CHECK(check_models(corpus) == std::set<std::string>{"BoxWithInfinites.glb"});
}

TEST_CASE("A sword keeps its thin blade") {
    const fs::path path = corpus / "sword/sword.obj";
    if (!fs::exists(path)) return test::skip("the model corpus is not beside the tree");
    RepairOptions options;
    options.pitch_mm = 0.1;
    for (const double size_mm : {20.0, 30.0}) {
        const RepairedMesh repaired = repair_mesh(read_at(path, size_mm), options);
        const VoxelGrid grid = grid_around(*repaired.solid, {0.1, 0.12, 0.1});
        const Solid solid(*repaired.solid, grid);
        SpanSlab kept;
        const std::uint64_t added = ThinFeatures(repaired.solid, solid).slab(0, grid.size[2], kept);
        CHECK(added > 0);
        CHECK(parts(voxels_of(kept)) == 1);
        CHECK(parts(voxels_of(kept)) <= parts(voxels_of(solid.slab(0, grid.size[2]))));
        // From pommel to tip.
        CHECK(kept.voxels_of_layer(0) > 0);
        CHECK(kept.voxels_of_layer(grid.size[2] - 1) > 0);
    }
}
