// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/numerics/quadrature.h"

#include <array>
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "tests/optics/reference.h"
#include "voxtone/optics/layered/phase.h"
#include "voxtone/optics/layered/slab.h"
#include "voxtone/optics/scene/fresnel.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

double moment(const Rule& rule, int power) {
    double sum = 0;
    for (std::size_t k = 0; k < rule.x.size(); ++k) sum += rule.w[k] * std::pow(rule.x[k], power);
    return sum;
}

}  // namespace

TEST_CASE("Gauss and Radau rules integrate the polynomials they promise, with many nodes too") {
    for (const int n : {1, 2, 3, 5, 8, 16, 32, 64, 100}) {
        const Rule gauss = gauss_legendre(n, 0, 2), radau = gauss_radau(n, 0, 2);
        CHECK(radau.x.back() == 2);
        for (int power = 0; power <= std::min(2 * n - 1, 40); ++power) {
            const double exact = std::pow(2.0, power + 1) / (power + 1);
            CHECK(moment(gauss, power) == Approx(exact).epsilon(1e-12));
            if (power <= 2 * n - 2) CHECK(moment(radau, power) == Approx(exact).epsilon(1e-12));
        }
    }
    // Beyond its degree a rule must miss: 2 nodes cannot integrate x^4, 2 Radau nodes not x^3.
    CHECK(std::abs(moment(gauss_legendre(2, 0, 1), 4) - 0.2) > 1e-3);
    CHECK(std::abs(moment(gauss_radau(2, 0, 1), 3) - 0.25) > 1e-3);
    // Abramowitz and Stegun, Table 25.4: n = 3 on (-1, 1).
    const Rule three = gauss_legendre(3, -1, 1);
    CHECK(three.x[2] == Approx(0.774596669241483));
    CHECK(three.w[2] == Approx(0.555555555555556));
}

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

TEST_CASE("Henyey-Greenstein matrices are Prahl's printed ones and normalised") {
    const auto& blocks = reference("published.json").at("prahl1995_worked_example").at("blocks");
    Eigen::ArrayXd nu(4);
    for (int k = 0; k < 4; ++k) nu[k] = blocks[0].at("angles")[static_cast<std::size_t>(k)];
    const PhaseMatrices h = henyey_greenstein(nu, 0.9, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
            // Five printed decimals of cosines and values.
            CHECK(h.same(row, column) == Approx(blocks[2].at("matrix")[i][j].get<double>()).margin(1e-4));
            CHECK(h.opposite(row, column) == Approx(blocks[3].at("matrix")[i][j].get<double>()).margin(1e-4));
        }
    }
    double correction = 1;
    const std::array<double, 1> look{1.0};
    const AngularGrid grid = angular_grid(1.5, 7, 7, look);
    const PhaseMatrices conserving = conserving_henyey_greenstein(grid, 0.4, 28, &correction);
    const Eigen::ArrayXd scattered =
        0.5 * ((conserving.same + conserving.opposite) * (grid.c / (2 * grid.nu)).matrix()).array();
    CHECK((scattered - 1).abs().maxCoeff() < 1e-12);
    CHECK(correction > 0);
    CHECK(correction < 1e-6);
    CHECK(conserving.same.isApprox(conserving.same.transpose(), 1e-14));
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
