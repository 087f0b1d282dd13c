// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/phase.h"

#include <array>

#include <catch2/catch.hpp>

#include "optics/layered/angular_grid.h"
#include "tests/optics/reference.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

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
    // What the quadrature alone misses of a particle's light, and a scaling of both sides that makes up for it.
    const PhaseMatrices plain = henyey_greenstein(grid.nu, 0.4, 28);
    const auto off = [&](const PhaseMatrices& of) {
        return (0.5 * ((of.same + of.opposite) * (grid.c / (2 * grid.nu)).matrix()).array() - 1).abs().maxCoeff();
    };
    CHECK(off(plain) > 1e-9);
    CHECK(off(conserving) < 1e-3 * off(plain));
    const Eigen::ArrayXd scaled = (conserving.same.diagonal().array() / plain.same.diagonal().array()).sqrt();
    CHECK(correction == Approx((scaled - 1).abs().maxCoeff()).epsilon(1e-6));
    CHECK(correction < 1e-6);
    CHECK(conserving.same.isApprox(conserving.same.transpose(), 1e-14));
}
