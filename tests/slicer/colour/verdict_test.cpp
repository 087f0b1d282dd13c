// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/verdict.h"

#include <catch2/catch.hpp>

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
