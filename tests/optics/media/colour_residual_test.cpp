// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/colour_residual.h"

#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/media/effective_medium.h"
#include "optics/media/resins.h"

namespace voxtone::optics {
namespace {

ColourResidual some_residual() {
    Eigen::MatrixXd centres(4, 3);
    centres << 1, 0, 0, 0.5, 0.5, 0, 0.2, 0.3, 0.5, 0.02, 0.98, 0;
    Eigen::MatrixX3d weights(4, 3);
    weights << 0.01, -0.02, 0.005, 0.03, 0.01, -0.01, -0.02, 0.02, 0.04, 0.01, 0.01, 0.02;
    return {{0.8, 1.2, 0.6}, centres, weights};
}

std::vector<double> random_shares(std::uint64_t which) {
    RandomStream random(11, which);
    std::vector<double> shares{random.uniform(), random.uniform(), random.uniform()};
    const double sum = shares[0] + shares[1] + shares[2];
    for (double& share : shares) share /= sum;
    return shares;
}

}  // namespace

TEST_CASE("A residual's derivatives are those of its values") {
    const ColourResidual residual = some_residual();
    for (std::uint64_t k = 0; k < 20; ++k) {
        std::vector<double> shares = random_shares(k);
        Eigen::Matrix3Xd by_share;
        const Eigen::Vector3d value = residual.with_gradient(shares, by_share);
        CHECK((value - residual(shares)).norm() < 1e-15);
        for (std::size_t r = 0; r < 3; ++r) {
            const double step = 1e-6, kept = shares[r];
            shares[r] = kept + step;
            const Eigen::Vector3d up = residual(shares);
            shares[r] = kept - step;
            const Eigen::Vector3d down = residual(shares);
            shares[r] = kept;
            CHECK((by_share.col(static_cast<Eigen::Index>(r)) - (up - down) / (2 * step)).norm() < 1e-6);
        }
    }
}

TEST_CASE("A residual is smooth at pure resins and fades away from its centres") {
    const ColourResidual residual = some_residual();
    const Eigen::Vector3d pure = residual(std::vector<double>{1, 0, 0});
    CHECK((residual(std::vector<double>{1 - 1e-6, 1e-6, 0}) - pure).norm() < 1e-5);
    // Far from all centres for lengths that are short: nothing is left.
    const ColourResidual narrow({0.02, 0.02, 0.02}, residual.centres(), residual.weights());
    CHECK(narrow(std::vector<double>{0.7, 0.1, 0.2}).norm() < 1e-8);
    CHECK(narrow(std::vector<double>{1, 0, 0}).norm() > 0.02);
    CHECK(ColourResidual()(std::vector<double>{0.5, 0.5}) == Eigen::Vector3d::Zero());
}

TEST_CASE("The residual of some resins of a set is that of mixtures without the others") {
    const ColourResidual residual = some_residual();
    const std::vector<std::size_t> chosen{2, 0};
    const ColourResidual part = residual.subset(chosen);
    for (const double f : {0.0, 0.1, 0.6, 1.0})
        CHECK((part(std::vector<double>{f, 1 - f}) - residual(std::vector<double>{1 - f, 0, f})).norm() < 1e-15);
    ResinSet set = vero_opaque();
    Eigen::MatrixXd centres(1, 5);
    centres << 0.2, 0.2, 0.2, 0.2, 0.2;
    set.residual = {{1, 1, 1, 1, 1}, centres, Eigen::MatrixX3d::Constant(1, 3, 0.1)};
    const std::vector<std::string> roles{"W", "C"};
    CHECK((set.subset(roles).residual(std::vector<double>{0.7, 0.3}) -
           set.residual(std::vector<double>{0.3, 0, 0, 0, 0.7}))
              .norm() < 1e-15);
    set.resins.pop_back();
    CHECK_THROWS_WITH(set.validate(), Catch::Contains("residual is of 5 resins, but the set has 4"));
}

TEST_CASE("A dot spread takes mixtures from sharp voxels to Eq. 7") {
    const std::array<double, 3> pitch{0.0423, 0.0847, 0.027};
    ResinSet set = vero_opaque();
    const std::vector<double> shares{0.2, 0.1, 0.3, 0, 0.4};
    const auto absorption = [&](double spread) {
        set.dot_spread = spread;
        return EffectiveMedium(set, pitch)(shares, 2).sigma_a;
    };
    const double sharp = absorption(0), ideal = set.mix(shares, 2).sigma_a;
    CHECK(absorption(1) == ideal);
    CHECK(absorption(1 - 1e-9) == Approx(ideal).epsilon(1e-7));
    CHECK(sharp < 0.98 * ideal);
    double last = sharp;
    for (const double spread : {0.25, 0.5, 0.75}) {
        CHECK(absorption(spread) > last);
        last = absorption(spread);
    }
    CHECK(last < ideal);
    set.dot_spread = 1.5;
    CHECK_THROWS_WITH(set.validate(), Catch::Contains("dot_spread is 1.5"));
}

}  // namespace voxtone::optics
