// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/fresnel.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "tests/optics/layered/slab.h"
#include "tests/optics/reference.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

TEST_CASE("Fresnel reflection has its closed values") {
    CHECK(fresnel_reflectance(1, 1.5) == Approx(0.04));
    CHECK(fresnel_reflectance(std::numbers::sqrt2 / 2, 1.5) == Approx(0.05023991).margin(1e-8));
    CHECK(fresnel_reflectance(1e-9, 1.5) == Approx(1).margin(1e-7));
    CHECK(fresnel_reflectance(0.3, 1) == Approx(0).margin(1e-15));
    // At Brewster's angle the parallel part vanishes: R = (1/2) ((eta^2 - 1)/(eta^2 + 1))^2.
    const double eta = 1.5, brewster = 1 / std::sqrt(1 + eta * eta);
    CHECK(fresnel_reflectance(brewster, eta) == Approx(0.5 * std::pow((eta * eta - 1) / (eta * eta + 1), 2)));
    CHECK(critical_cosine(1.5) == Approx(0.745355992));
    CHECK(cosine_in_resin(std::numbers::sqrt2 / 2, 1.5) == Approx(0.8819171).margin(1e-7));
}

TEST_CASE("Diffuse light meets the surface's tabulated reflectance") {
    // Rows of albedo 0 and infinite depth: Fresnel reflection alone, converged to 1e-11.
    int rows = 0;
    for (const auto& row : reference("slab_rt.json").at("rows")) {
        if (row[2] != 0 || !row[3].is_string() || row[1] != 0) continue;
        const FluxTotals totals = unscattered(row[0].get<double>(), INFINITY);
        CHECK(totals.UR1 == Approx(row[4].get<double>()).margin(1e-8));
        CHECK(totals.URU == Approx(row[6].get<double>()).margin(1e-8));
        ++rows;
    }
    CHECK(rows == 3);
}
