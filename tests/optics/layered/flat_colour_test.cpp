// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/flat_colour.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>

#include "optics/colour/colour.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::optics {

TEST_CASE("A half-space's tabulated reflectance is that of its modes") {
    const OrdinatePlan plan = directional_plan(0.4, 1.5);
    const HalfSpaceReflectance table(0.4, 1.5, MeasuringGeometry::directional_45_0);
    for (const double loss : {0.0, 1e-6, 1e-4, 0.0037, 0.05, 0.33, 0.71, 0.95}) {
        const Medium medium{3 * loss, 3 * (1 - loss)};
        const double exact = reflectance_factor(plan, half_space(plan, medium), std::numbers::sqrt2 / 2, 1.0);
        CAPTURE(loss);
        CHECK(std::abs(table(medium) - exact) < 1e-6);
    }
}

TEST_CASE("A half-space's reflectance depends on its albedo alone, and its derivatives are right") {
    for (const auto geometry : {MeasuringGeometry::directional_45_0, MeasuringGeometry::diffuse_8}) {
        const HalfSpaceReflectance table(0.4, 1.5, geometry);
        CHECK(table({0.2, 1}) == Approx(table({2, 10})).epsilon(1e-12));
        CHECK(table({0, 5}) > 0.9);
        CHECK(table({5, 0}) < 1e-3);
        for (const double loss : {0.001, 0.03, 0.4, 0.9}) {
            const Medium m{4 * loss, 4 * (1 - loss)};
            const auto value = table.with_gradient(m);
            const double h = 1e-6;
            CHECK(value.by_absorption ==
                  Approx((table({m.sigma_a + h, m.sigma_s}) - table({m.sigma_a - h, m.sigma_s})) / (2 * h))
                      .epsilon(1e-4));
            CHECK(value.by_scattering ==
                  Approx((table({m.sigma_a, m.sigma_s + h}) - table({m.sigma_a, m.sigma_s - h})) / (2 * h))
                      .epsilon(1e-4));
        }
    }
}

TEST_CASE("Diffuse light and light from 45 degrees read a half-space nearly alike") {
    const HalfSpaceReflectance directional(0.4, 1.5, MeasuringGeometry::directional_45_0),
        diffuse(0.4, 1.5, MeasuringGeometry::diffuse_8);
    for (const double loss : {0.001, 0.03, 0.4}) {
        const Medium medium{loss, 1 - loss};
        CHECK(diffuse(medium) == Approx(directional(medium)).epsilon(0.1));
    }
}

TEST_CASE("A flat colour without a residual is the physics, with one it is moved by it") {
    ResinSet set = vero_opaque();
    const std::vector<double> shares{0.3, 0, 0.1, 0, 0.6};
    const FlatColour plain(set);
    CHECK(plain.xyz(shares) == plain.physics(shares));
    CHECK(plain.ratio(shares) == Eigen::Vector3d::Ones());

    Eigen::MatrixXd centres(1, 5);
    centres << 0.3, 0, 0.1, 0, 0.6;
    const Eigen::Vector3d moved(0.01, -0.02, 0.03);
    set.residual = {{1, 1, 1, 1, 1}, centres, moved.transpose()};
    const FlatColour corrected(set);
    const Eigen::Vector3d step =
        lab_roots(corrected.xyz(shares), corrected.white()) - lab_roots(corrected.physics(shares), corrected.white());
    CHECK((step - moved).norm() < 1e-12);
    CHECK((corrected.ratio(shares).cwiseProduct(corrected.physics(shares)) - corrected.xyz(shares)).norm() < 1e-12);
    CHECK((corrected.lab(shares) - lab_from_xyz(corrected.xyz(shares), corrected.white())).norm() < 1e-12);
}

TEST_CASE("CIELAB's roots go both ways, below black too") {
    const Eigen::Vector3d white = d50_white();
    for (const double y : {-0.02, 0.0, 0.003, 0.0089, 0.2, 1.1}) {
        const Eigen::Vector3d xyz(0.9 * y, y, 0.5 * y);
        CHECK((xyz_of_roots(lab_roots(xyz, white), white) - xyz).norm() < 1e-14);
    }
}

TEST_CASE("What the instrument adds is added: surface and gain") {
    ResinSet set = vero_opaque();
    const std::vector<double> black{0, 0, 0, 1, 0};
    const double own = FlatColour(set).physics(black).y();
    set.measured = {MeasuringGeometry::directional_45_0, 0.01, 0.9};
    CHECK(FlatColour(set).physics(black).y() == Approx(0.9 * (own + 0.01)).epsilon(1e-12));
}

}  // namespace voxtone::optics
