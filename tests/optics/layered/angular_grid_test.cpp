// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/angular_grid.h"

#include <array>
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "optics/scene/fresnel.h"

using namespace voxtone::optics;

TEST_CASE("Grids carry all the flux and hold the directions asked for") {
    const double cos_45 = std::numbers::sqrt2 / 2;
    for (const double eta : {1.0, 1.3, 1.5}) {
        const std::array<double, 2> look{cos_45, 1.0};
        for (const AngularGrid& grid : {angular_grid(eta, 6, 8, look), angular_grid_45_0(eta, 6, 5, 4)}) {
            CHECK(grid.c.sum() == Approx(1).epsilon(1e-12));
            CHECK(grid.mu[grid.find(1.0)] == 1);
            CHECK(grid.trapped == (eta > 1 ? 6 : 0));
            for (int k = 1; k < grid.size(); ++k) CHECK(grid.nu[k] > grid.nu[k - 1]);
            for (int k = 0; k < grid.size(); ++k) CHECK((grid.mu[k] == 0) == (grid.nu[k] < critical_cosine(eta)));
        }
        CHECK(angular_grid(eta, 6, 8, look).c[angular_grid(eta, 6, 8, look).find(cos_45)] == 0);
    }
}
