// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/surface.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "base/random.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

double face_area(const SurfaceFace& face) {
    const auto axis = static_cast<std::size_t>(face.facing) / 2;
    return j750[(axis + 1) % 3] * j750[(axis + 2) % 3];
}

}  // namespace

// Where the body is alike in opposite directions the gradient of its occupancy is nothing but rounding: taken for a
// direction, it made one cell stand for more area than the rest of the body.
TEST_CASE("No face stands for more than its own area, also where the body is alike in opposite directions") {
    const ResinSet resins = vero_opaque();
    const std::array<int, 3> cell = cell_voxels(j750, 0.085);
    REQUIRE(cell == std::array<int, 3>{2, 1, 3});
    constexpr int middle = 7, cells = 2 * middle + 1;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        // Random cells around the one in the middle, each with the one opposite.
        const auto filled = [&](int x, int y, int z) {
            const int i = (z * cells + y) * cells + x, opposite = cells * cells * cells - 1 - i;
            voxtone::RandomStream random(seed, static_cast<std::uint64_t>(std::min(i, opposite)));
            return i == opposite || random.uniform() < 0.5;
        };
        const ResinVolume volume = make_resin_volume(
            {cells * cell[0], cells * cell[1], cells * cell[2]}, j750,
            [&](int x, int y, int z) { return filled(x / cell[0], y / cell[1], z / cell[2]) ? 1 : 0; });
        const Scene scene{.volume = &volume, .resins = &resins};
        const Surface surface = find_surface(scene, cell, SurfacePart::all);
        std::size_t too_large = 0, no_direction = 0;
        for (std::size_t c = 0; c < surface.cells.size(); ++c) {
            const SurfaceCell& of_surface = surface.cells[c];
            double most = 0;
            for (std::uint32_t f = 0; f < of_surface.faces; ++f) {
                most += face_area(surface.faces[of_surface.first_face + f]);
                const auto n = surface.normal_at(c, of_surface.first_face + f);
                no_direction += std::abs(std::hypot(n[0], n[1], n[2]) - 1) > 1e-5;
            }
            too_large += !(of_surface.area_mm2 <= 1.0001 * most);
        }
        INFO("seed " << seed);
        CHECK(too_large == 0);
        CHECK(no_direction == 0);
    }
}

TEST_CASE("Cells of a surface are in order of z, y, x, those of a relief seen from above too") {
    const ResinSet resins = vero_opaque();
    const std::array<int, 3> cell = cell_voxels(j750, 0.085);
    const ResinVolume relief = make_resin_volume(
        {8 * cell[0], 8 * cell[1], 8 * cell[2]}, j750,
        [&](int x, int y, int z) { return z / cell[2] <= (x / cell[0] * 5 + y / cell[1] * 3) % 8 ? 1 : 0; });
    const Scene scene{.volume = &relief, .resins = &resins};
    for (const SurfacePart part : {SurfacePart::all, SurfacePart::top}) {
        const Surface surface = find_surface(scene, cell, part);
        REQUIRE(surface.cells.size() >= 64);
        CHECK(std::ranges::is_sorted(surface.cells, {}, [](const SurfaceCell& one) {
            return std::tuple(one.cell[2], one.cell[1], one.cell[0]);
        }));
    }
}

TEST_CASE("a row of voxels too long for a face's place is refused, the longest that fits has its last face") {
    const ResinSet resins = vero_opaque();
    const auto row = [](int voxels) {
        return make_resin_volume({voxels, 1, 1}, j750, [](int, int, int) { return Material(1); });
    };
    const ResinVolume fits = row(65'536), too_long = row(65'537);
    const Surface surface = find_surface({.volume = &fits, .resins = &resins}, {2, 1, 3}, SurfacePart::all);
    const auto last = std::ranges::find(surface.faces, Facing::plus_x, &SurfaceFace::facing);
    REQUIRE(last != surface.faces.end());
    CHECK(last->voxel[0] == 65'535);
    CHECK_THROWS_AS(find_surface({.volume = &too_long, .resins = &resins}, {2, 1, 3}, SurfacePart::all),
                    voxtone::ResourceError);
}
