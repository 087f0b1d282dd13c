// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/verdict.h"

#include <catch2/catch.hpp>

#include "drawn_page.h"

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("A wall is as thick as it is, along its normal") {
    // A plate of 0.8 mm between y = 2 and 2.8 mm, of voxels of 0.05 x 0.1 x 0.02 mm.
    const auto plate = optics::make_resin_volume({60, 50, 100}, {0.05, 0.1, 0.02}, [](int, int y, int) {
        return y >= 20 && y < 28 ? optics::Material{1} : optics::air;
    });
    const Eigen::Vector3d front(1.5, 2, 1), back(1.5, 2.8, 1);
    CHECK(wall_thickness_mm(plate, front, {0, -1, 0}, 2) == Approx(0.8).margin(0.05));
    CHECK(wall_thickness_mm(plate, back, {0, 1, 0}, 2) == Approx(0.8).margin(0.05));
    // Aslant the way through is longer.
    CHECK(wall_thickness_mm(plate, front, Eigen::Vector3d(0, -1, -1).normalized(), 2) ==
          Approx(0.8 * std::sqrt(2)).margin(0.1));
    // Along the plate there is no end in sight.
    CHECK(wall_thickness_mm(plate, {0.5, 2.4, 1}, {-1, 0, 0}, 2) == 2);
    // A cell's centre may lie a little outside of the staircase.
    CHECK(wall_thickness_mm(plate, {1.5, 1.95, 1}, {0, -1, 0}, 2) == Approx(0.85).margin(0.06));
}

TEST_CASE("A sheet of one voxel is a thin wall whichever way it stands, and a block is none") {
    for (const int axis : {0, 1, 2}) {
        CAPTURE(axis);
        const auto turned = [axis](double x, double y, double z) {
            return axis == 0 ? std::array{x, y, z} : axis == 1 ? std::array{y, z, x} : std::array{z, x, y};
        };
        const auto is_solid = [&](double x, double y, double z) {
            const auto at = turned(x, y, z);
            return at[2] < 3 || std::abs(at[0] - 20.5 * test::drawn_cell_mm) < 0.1 * test::drawn_cell_mm;
        };
        const JobPrediction p = test::body_of({4.5, 4.5, 4.5}, is_solid,
                                              [](double, double, double) { return Eigen::Vector3f::Constant(0.5f); });
        int sheet = 0, block = 0;
        for (std::size_t i = 0; i < p.target.size(); ++i) {
            const auto& c = p.predicted.surface.cells[i].centre_mm;
            const auto at = turned(double(c[0]), double(c[1]), double(c[2]));
            const double wall = wall_of_cell_mm(p, i, 2);
            const bool is_sheet = at[2] > 3.3 && at[2] < 4.2 && std::abs(at[1] - 2.2) < 1.8,
                       is_side = at[2] < 2.5 && at[2] > 1 && std::abs(at[1] - 2) < 0.5;
            if (is_sheet) CHECK(wall < 0.2);
            if (is_side) CHECK(wall > 1.5);
            sheet += is_sheet, block += is_side;
        }
        CHECK((sheet > 100 && block > 100));
    }
}
