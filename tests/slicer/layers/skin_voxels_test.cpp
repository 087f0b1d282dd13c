// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/skin_voxels.h"

#include <cmath>
#include <map>
#include <mutex>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/layered/shell_appearance.h"
#include "slicer/layers/block_fill.h"
#include "slicer/layers/skin_source.h"
#include "tests/same_for_threads.h"
#include "tests/slicer/layers/made_voxels.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using voxtone::test::made_voxels;
using voxtone::test::MadeVoxels;

namespace {

constexpr double radius_mm = 0.9;
constexpr std::size_t resins = 4;

VisibleSurface all_of_it(const SolidMesh& mesh) {
    VisibleSurface surface;
    surface.positions_mm = mesh.positions_mm;
    surface.triangles = mesh.triangles;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) surface.source_triangle.push_back(t);
    surface.source_uv.assign(mesh.triangles.size(),
                             {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    return surface;
}

/// A sphere that no block of the volume or of the shell begins or ends with, and a skin of some cells and layers.
struct Ball {
    std::array<double, 3> pitch_mm;
    VoxelGrid grid;
    SolidMesh mesh = shapes::moved(shapes::sphere(radius_mm, 9), Vector3d::Constant(radius_mm + 0.11));
    VisibleSurface surface = all_of_it(mesh);
    SurfaceIndex index{surface};
    SurfacePlaces places{surface, Vector3d::Zero()};
    halftone::SkinLayers layers{{0.05, 0.11, 0.3}};
    std::optional<CellIndex> cells;
    std::optional<SurfaceShell> shell;
    std::optional<Solid> solid;
    optics::ResinVolume body;
    static constexpr std::size_t cell_count = 40;

    explicit Ball(const std::array<double, 3>& pitch) : pitch_mm(pitch) {
        grid.pitch_mm = {pitch[0], pitch[1], pitch[2]};
        for (std::size_t a = 0; a < 3; ++a) grid.size[a] = static_cast<int>(2 * (radius_mm + 0.11) / pitch[a]) + 1;
        optics::Surface seen;
        seen.cell_voxels = {2, 1, 3};
        for (std::size_t c = 0; c < cell_count; ++c) {
            RandomStream random(3, c);
            const Vector3d way =
                Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5).normalized();
            optics::SurfaceCell& cell = seen.cells.emplace_back();
            for (std::size_t a = 0; a < 3; ++a) {
                const double at = radius_mm + 0.11 + radius_mm * way[static_cast<Eigen::Index>(a)];
                cell.centre_mm[a] = static_cast<float>(at);
                cell.cell[a] = static_cast<std::int32_t>(at / (pitch[a] * seen.cell_voxels[a]));
            }
        }
        cells.emplace(seen, pitch);
        shell.emplace(index, grid, 0.35);
        solid.emplace(mesh, grid);
        const SpanSlab spans = solid->slab(0, grid.size[2]);
        body = optics::make_resin_volume(grid.size, pitch, [&](int x, int y, int z) {
            for (const Span& span : spans.row(y, z))
                if (span.begin <= x && x < span.end) return 3;
            return 0;
        });
    }

    [[nodiscard]] SkinMap map() const { return {places, *cells, layers}; }
    [[nodiscard]] std::optional<SkinVoxels> kept(std::uint64_t most_bytes) const {
        const auto visit_slab = [&](int slab, const std::function<void(const ShellBlock&)>& visit) {
            const int depth = shell->block_size()[2], first = slab * depth;
            const SpanSlab spans = solid->slab(first, std::min(first + depth, grid.size[2]));
            for (int row = 0; row < shell->block_rows(); ++row) shell->for_each_block(row, slab, spans, visit);
        };
        const auto number_of = [&](const ShellBlock& block, int at) {
            const std::size_t n = map().at(block.triangle[at], block.u[at], block.v[at], block.distance_mm[at]);
            return n == SkinMap::core ? SkinVoxels::core : static_cast<std::uint32_t>(n);
        };
        return SkinVoxels::of(grid, shell->block_size()[2], visit_slab, number_of, most_bytes);
    }
    [[nodiscard]] halftone::SkinMixtures mixtures() const {
        halftone::SkinMixtures skin(cell_count, layers.size(), resins);
        for (std::size_t i = 0; i < skin.all().size(); ++i)
            skin.all()[i] = static_cast<float>(RandomStream(5, i).uniform());
        return skin;
    }
};

constexpr std::array<double, 3> j750{25.4 / 600, 25.4 / 300, 0.027}, cubes{0.037, 0.037, 0.037};
constexpr std::uint64_t plenty = 1 << 30;

}  // namespace

TEST_CASE("A print of kept voxels is that of a search for each of them") {
    for (const auto& pitch_mm : {j750, cubes}) {
        CAPTURE(pitch_mm[1]);
        const Ball ball(pitch_mm);
        const halftone::SkinMixtures mixtures = ball.mixtures();
        const halftone::BlueNoiseScreen screen(pitch_mm);
        const optics::ResinSet set = optics::vero_opaque().subset(std::vector<std::string>{"C", "M", "Y", "W"});
        optics::ShellGeometry geometry;
        geometry.core_resin = set.find("W");
        const optics::ShellAppearance appearance(set, geometry);
        halftone::SeparationOptions options;
        options.nodes = 2;
        const halftone::Separation separation(appearance, options);
        io::TexturedMesh textured;
        textured.positions = ball.surface.positions_mm;
        textured.triangles = ball.surface.triangles;
        textured.material_of_triangle.assign(textured.triangles.size(), 0);
        textured.materials.emplace_back();
        const SurfaceColour colour(textured, pitch_mm[0]);
        const SkinSource skin(ball.map(), mixtures, 3);
        const MadeVoxels made = made_voxels({*ball.solid, nullptr, ball.surface, *ball.shell, 4,
                                             MixtureSources{colour, separation, &screen, 1, &skin}});

        const std::optional<SkinVoxels> kept = ball.kept(plenty);
        REQUIRE(kept);
        const auto print = [&] {
            const optics::ResinVolume volume =
                kept->print(ball.body, 4, halftone::cumulative_mixtures(mixtures), int{resins}, screen, Progress());
            std::vector<int> materials;
            for (int k = 0; k < ball.grid.size[2]; ++k)
                for (int j = 0; j < ball.grid.size[1]; ++j)
                    for (int i = 0; i < ball.grid.size[0]; ++i) materials.push_back(volume.at(i, j, k));
            return materials;
        };
        const std::vector<int> materials = test::same_for_threads(print);
        std::size_t wrong = 0, next = 0;
        std::array<std::size_t, resins + 1> of_resin{};
        for (int k = 0; k < ball.grid.size[2]; ++k)
            for (int j = 0; j < ball.grid.size[1]; ++j)
                for (int i = 0; i < ball.grid.size[0]; ++i, ++next) {
                    wrong += materials[next] != made.at(i, j, k);
                    ++of_resin[static_cast<std::size_t>(materials[next])];
                }
        CHECK(wrong == 0);
        for (const std::size_t count : of_resin) CHECK(count > 1000);
    }
}

TEST_CASE("Kept voxels are handed over with their numbers, each once, in a box too") {
    const Ball ball(j750);
    std::map<std::array<int, 3>, std::uint32_t> expected;
    const SpanSlab spans = ball.solid->slab(0, ball.grid.size[2]);
    for (int slab = 0; slab < ball.shell->block_layers(); ++slab)
        for (int row = 0; row < ball.shell->block_rows(); ++row)
            ball.shell->for_each_block(row, slab, spans, [&](const ShellBlock& block) {
                for_each_shell_voxel(block, [&](int r, int lane) {
                    const int at = r * ShellBlock::width + lane;
                    const std::size_t n =
                        ball.map().at(block.triangle[at], block.u[at], block.v[at], block.distance_mm[at]);
                    if (n != SkinMap::core)
                        expected[{block.origin[0] + lane, block.origin[1] + r % block.size[1],
                                  block.origin[2] + r / block.size[1]}] = static_cast<std::uint32_t>(n);
                });
            });
    const std::optional<SkinVoxels> kept = ball.kept(plenty);
    REQUIRE(kept);
    std::vector<optics::VoxelBox> boxes{{{-5, -5, -5}, {1000, 1000, 1000}},
                                        {{3, 7, 17}, {33, 17, 40}},
                                        {{0, 0, 0}, {1, 1, 1}},
                                        {{900, 0, 0}, {910, 10, 10}}};
    // Some that begin and end in other blocks along each axis.
    for (std::uint64_t n = 0; n < 24; ++n) {
        RandomStream random(7, n);
        optics::VoxelBox& box = boxes.emplace_back();
        for (std::size_t a = 0; a < 3; ++a) {
            box.begin[a] = static_cast<int>(random.uniform() * ball.grid.size[a]);
            box.end[a] = box.begin[a] + 1 + static_cast<int>(random.uniform() * (ball.grid.size[a] + 20));
        }
    }
    for (const optics::VoxelBox& box : boxes) {
        std::map<std::array<int, 3>, std::uint32_t> inside, found;
        for (const auto& [voxel, number] : expected)
            if (box.holds(voxel)) inside.emplace(voxel, number);
        std::mutex mutex;
        bool twice = false;
        kept->for_each(
            box,
            [&](const std::array<int, 3>& voxel, std::uint32_t number) {
                const std::scoped_lock lock(mutex);
                twice |= !found.emplace(voxel, number).second;
            },
            Progress());
        CHECK(!twice);
        CHECK(found == inside);
    }
}

TEST_CASE("Voxels that take more than they may are not kept") {
    const Ball ball(j750);
    const std::optional<SkinVoxels> kept = ball.kept(plenty);
    REQUIRE(kept);
    CHECK(kept->memory_bytes() > 10'000);
    CHECK(!ball.kept(10'000));
}
