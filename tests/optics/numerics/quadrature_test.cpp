// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/quadrature.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

using namespace voxtone::optics;

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
