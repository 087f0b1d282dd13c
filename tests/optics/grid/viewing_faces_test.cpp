// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/viewing_faces.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "optics/grid/lattice.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/scene/appearance_model.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> viewing_cell{2, 1, 3};

/// A ball: every slope there is, and flat places between them.
struct Ball {
    ResinSet set = vero_opaque();
    ResinVolume volume = make_resin_volume({52, 27, 80}, j750, [](int x, int y, int z) {
        return std::hypot((x - 25.6) * j750[0], (y - 13.3) * j750[1], (z - 39.2) * j750[2]) < 1 ? 5 : 0;
    });
    Scene scene{&volume, &set, Backing::none, Sides::open};
    Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    ViewingGrid grid =
        make_viewing_grid(scene, viewing_cell, {0.8}, {}, {{}, BlockLattice(volume.size(), viewing_cell).blocks, {}});
};

}  // namespace

TEST_CASE("Faces stand for as much as the cell has that is seen through them, slanting or not") {
    const Ball ball;
    const ViewingFaces seen = find_viewing_faces(ball.grid, ball.surface);
    REQUIRE(seen.first.size() == ball.surface.cells.size() + 1);
    double worst = 0, sum = 0;
    std::size_t slanting = 0;
    for (std::size_t i = 0; i < ball.surface.cells.size(); ++i) {
        const SurfaceCell& cell = ball.surface.cells[i];
        double own = 0, standing = 0;
        for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
            const auto a = static_cast<std::size_t>(ball.surface.faces[f].facing) / 2;
            own += j750[(a + 1) % 3] * j750[(a + 2) % 3];
        }
        for (std::size_t e = seen.first[i]; e < seen.first[i + 1]; ++e)
            standing += double(seen.share[e]) * double(ball.grid.faces[seen.face[e]].area_mm2);
        worst = std::max(worst, std::abs(standing / own - 1));
        sum += standing / own;
        slanting += seen.first[i + 1] - seen.first[i] > 3;
    }
    INFO("worst " << worst << ", mean " << sum / double(ball.surface.cells.size()) << ", slanting " << slanting);
    CHECK(slanting > ball.surface.cells.size() / 2);
    // Faces of which less than a hundredth is seen are left out: eight of the nine around at most, few on average.
    CHECK(worst < 0.08);
    CHECK(sum / double(ball.surface.cells.size()) == Approx(1).margin(0.01));
}

TEST_CASE("Faces that stand for a cell lie where the cell's own lie") {
    const Ball ball;
    const ViewingFaces seen = find_viewing_faces(ball.grid, ball.surface);
    const auto edge = ball.grid.edge_mm();
    // Where each face of the grid is, by its cell's place.
    std::vector<std::array<double, 3>> middle(ball.grid.faces.size());
    for_each({4 * ball.grid.lattice[0], 4 * ball.grid.lattice[1], 4 * ball.grid.lattice[2]}, [&](const Place& at) {
        const std::int64_t cell = ball.grid.cell_of(at);
        if (cell < 0) return;
        ball.grid.each_face(static_cast<std::uint32_t>(cell), [&](std::uint32_t f) {
            const auto facing = static_cast<std::size_t>(ball.grid.faces[f].facing);
            for (std::size_t a = 0; a < 3; ++a)
                middle[f][a] = (at[a] + (facing / 2 == a ? (facing % 2 ? 1.0 : 0.0) : 0.5)) * edge[a] -
                               ball.grid.shift_voxels[a] * j750[a];
        });
    });
    // By facing, the mean along the way it looks: steps of a cell's height around have a mean of none.
    std::array<double, 6> off{}, count{};
    for (std::size_t i = 0; i < ball.surface.cells.size(); ++i) {
        const SurfaceCell& cell = ball.surface.cells[i];
        std::array<double, 6> own{}, faces{}, standing{}, area{};
        for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
            const SurfaceFace& face = ball.surface.faces[f];
            const auto facing = static_cast<std::size_t>(face.facing);
            own[facing] += (face.voxel[facing / 2] + int(facing % 2)) * j750[facing / 2];
            faces[facing] += 1;
        }
        for (std::size_t e = seen.first[i]; e < seen.first[i + 1]; ++e) {
            const OuterFace& face = ball.grid.faces[seen.face[e]];
            const auto facing = static_cast<std::size_t>(face.facing);
            const double a = double(seen.share[e]) * double(face.area_mm2);
            standing[facing] += a * middle[seen.face[e]][facing / 2];
            area[facing] += a;
        }
        for (std::size_t f = 0; f < 6; ++f)
            if (faces[f] > 0 && area[f] > 0) {
                off[f] += standing[f] / area[f] - own[f] / faces[f];
                ++count[f];
            }
    }
    for (std::size_t f = 0; f < 6; ++f) {
        INFO("facing " << f << ": " << off[f] / count[f] << " mm");
        CHECK(count[f] > 200);
        CHECK(std::abs(off[f] / count[f]) < 0.15 * edge[f / 2]);
    }
}
