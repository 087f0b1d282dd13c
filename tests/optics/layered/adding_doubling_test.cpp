// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/adding_doubling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "optics/layered/directional.h"
#include "tests/optics/layered/slab.h"
#include "tests/optics/reference.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;
using Eigen::ArrayXd;
using Eigen::MatrixXd;

namespace {

// Relative intensity and optical depth instead of mm^-1 and mm.
Medium of_albedo(double albedo) { return {1 - albedo, albedo}; }

AddingDoubling solver_looking_along(double eta, double g, int below, int above, std::vector<double> look, int terms) {
    return {angular_grid(eta, below, above, look), g, terms};
}

struct SlabErrors {
    double unscattered = 0, totals = 0;
    std::size_t rows = 0;
};

double deviation(const FluxTotals& totals, const nlohmann::json& row, std::size_t first) {
    const std::array<double, 4> values{totals.UR1, totals.UT1, totals.URU, totals.UTU};
    double worst = 0;
    for (std::size_t k = 0; k < 4; ++k) worst = std::max(worst, std::abs(values[k] - row[first + k].get<double>()));
    return worst;
}

// The worst deviation from the rows of slab_rt.json that `chosen` picks, with `half` + `half` directions and 4 `half`
// terms.
template <class Chosen>
SlabErrors worst_deviation(int half, Chosen&& chosen) {
    std::vector<nlohmann::json> rows;
    for (const auto& row : reference("slab_rt.json").at("rows")) {
        if (chosen(row[0].get<double>(), row[1].get<double>())) rows.push_back(row);
    }
    std::vector<SlabErrors> errors(rows.size());
    parallel_for(0, rows.size(), 1, [&](std::size_t i) {
        const double eta = rows[i][0], g = rows[i][1], albedo = rows[i][2];
        const bool endless = rows[i][3].is_string();
        const double tau = endless ? INFINITY : rows[i][3].get<double>();
        const AddingDoubling solver = solver_looking_along(eta, g, half, half, {1.0}, 4 * half);
        const FluxTotals totals = endless ? half_space_totals(solver.grid(), solver.half_space(of_albedo(albedo)))
                                          : slab_totals(solver.grid(), solver.layer(of_albedo(albedo), tau));
        errors[i] = {deviation(unscattered(eta, tau), rows[i], 8), deviation(totals, rows[i], 4), 1};
    });
    SlabErrors worst;
    for (const SlabErrors& error : errors) {
        worst.totals = std::max(worst.totals, error.totals);
        worst.unscattered = std::max(worst.unscattered, error.unscattered);
        worst.rows += error.rows;
    }
    return worst;
}

double largest_difference(const MatrixXd& a, const MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("Slab totals are those of the reference: mild phase functions, 16 directions") {
    const SlabErrors worst = worst_deviation(8, [](double, double g) { return std::abs(g) <= 0.5; });
    INFO(worst.totals << " totals, " << worst.unscattered << " unscattered");
    CHECK(worst.rows == 639);
    CHECK(worst.totals < 1e-5);
    CHECK(worst.unscattered < 1e-7);
}

TEST_CASE("Slab totals are those of the reference: g = 0.875, 32 directions") {
    const SlabErrors worst = worst_deviation(16, [](double, double g) { return g > 0.5; });
    INFO(worst.totals);
    CHECK(worst.rows == 213);
    CHECK(worst.totals < 1e-4);
}

TEST_CASE("Half-spaces follow Chandrasekhar's H functions") {
    for (const auto& table : reference("published.json").at("chandrasekhar_H").at("tables")) {
        const std::vector<double> mu = table.at("mu"), plane_albedo = table.at("plane_albedo_1_minus_H_sqrt");
        std::vector<double> look = mu;
        const AddingDoubling solver = solver_looking_along(1, 0, 0, 32, look, 1);
        const AngularGrid& grid = solver.grid();
        const MatrixXd R = solver.half_space(of_albedo(table.at("albedo")));
        const ArrayXd flux = (R.transpose() * grid.c.matrix()).array();
        for (std::size_t i = 0; i < mu.size(); ++i) {
            CHECK(flux[grid.find(mu[i])] == Approx(plane_albedo[i]).margin(1e-7));
            for (std::size_t j = 0; j < mu.size(); ++j) {
                const double rho = table.at("rho_mu_mu0")[i][j];
                CHECK(R(grid.find(mu[i]), grid.find(mu[j])) == Approx(rho).epsilon(1e-6));
            }
        }
    }
}

TEST_CASE("Published slabs of van de Hulst, Giovanelli and others are met") {
    for (const auto& check : reference("published.json").at("slab_checks")) {
        const auto& conditions = check.at("conditions");
        const double mu_0 = conditions.value("mu0", 1.0), albedo = conditions.at("albedo");
        std::vector<double> look{1.0};
        if (mu_0 != 1) look.push_back(mu_0);
        const AddingDoubling solver = solver_looking_along(conditions.at("n"), conditions.at("g"), 16, 16, look, 64);
        const AngularGrid& grid = solver.grid();
        const auto& converged = check.at("converged_here");
        if (conditions.at("tau").is_string()) {
            const FluxTotals totals = half_space_totals(grid, solver.half_space(of_albedo(albedo)));
            CHECK(totals.UR1 == Approx(converged.at("UR1").get<double>()).margin(2e-7));
            if (check.at("published").contains("R")) {  // Giovanelli's last digits are 8e-5 high
                CHECK(totals.UR1 == Approx(check.at("published").at("R").get<double>()).margin(1e-4));
            }
            continue;
        }
        const LayerResponse slab = solver.layer(of_albedo(albedo), conditions.at("tau"));
        const int in = grid.find(mu_0);
        const double reflected = grid.c.matrix().dot(slab.R_above.col(in));
        const double transmitted = grid.c.matrix().dot(slab.D_down.col(in)) + slab.direct[in];
        CHECK(reflected == Approx(check.at("published").at("R").get<double>()).margin(6e-6));
        CHECK(transmitted == Approx(check.at("published").at("T").get<double>()).margin(6e-6));
        CHECK(reflected == Approx(converged.value("R", converged.value("UR1", 0.0))).margin(2e-7));
        CHECK(transmitted == Approx(converged.value("T", converged.value("UT1", 0.0))).margin(2e-7));
    }
}

TEST_CASE("Radiances leave slabs as in van de Hulst's Tables 12 and 35") {
    for (const auto& entry : reference("published.json").at("disort_angular")) {
        const std::vector<double> mu = entry.at("mu"), up = entry.at("converged_I_up_top");
        const std::vector<double> down = entry.at("converged_I_down_bottom_order_mu_1_0p5_0p1");
        const AddingDoubling solver = solver_looking_along(1, entry.at("g"), 0, 48, mu, 96);
        const AngularGrid& grid = solver.grid();
        const LayerResponse slab = solver.layer(of_albedo(entry.at("albedo")), entry.at("tau"));
        ArrayXd I_up, I_down;
        if (entry.contains("mu0")) {
            const int in = grid.find(entry.at("mu0"));
            I_up = slab.R_above.col(in);
            I_down = slab.D_down.col(in);
            const double pi = 3.14159265358979;
            CHECK(pi * (grid.c * I_up).sum() == Approx(entry.at("converged_flux_up").get<double>()).margin(1e-6));
            CHECK(pi * (grid.c * I_down).sum() ==
                  Approx(entry.at("converged_flux_down_diffuse").get<double>()).margin(1e-6));
        } else {  // isotropic light of radiance 1, the direct beam counted
            I_up = (slab.R_above * grid.c.matrix()).array();
            I_down = (slab.D_down * grid.c.matrix()).array() + slab.direct;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(I_up[grid.find(mu[k])] == Approx(up[k]).margin(2e-6));
            CHECK(I_down[grid.find(mu[k])] == Approx(down[2 - k]).margin(2e-6));
        }
    }
}

TEST_CASE("A layer that absorbs nothing loses nothing, and every layer is reciprocal") {
    const AddingDoubling solver = solver_looking_along(1.5, 0.4, 6, 6, {1.0}, 24);
    const AngularGrid& grid = solver.grid();
    for (const double tau : {1e-3, 0.1, 1.0, 30.0, 1000.0}) {
        const LayerResponse slab = solver.layer(of_albedo(1), tau);
        const ArrayXd out = ((slab.R_above + slab.D_down).transpose() * grid.c.matrix()).array() + slab.direct;
        CHECK((out - 1).abs().maxCoeff() < 1e-7);
        const FluxTotals totals = slab_totals(grid, slab);
        CHECK(totals.UR1 + totals.UT1 == Approx(1).margin(1e-7));
    }
    const Medium cyan{1.35, 3.15}, white{0.0027, 8.9973};
    const LayerResponse upper = solver.layer(cyan, 0.2), lower = solver.layer(white, 0.4),
                        both = solver.add(upper, lower);
    CHECK(largest_difference(upper.R_above, upper.R_above.transpose()) < 1e-12);
    CHECK(largest_difference(both.R_above, both.R_above.transpose()) < 1e-11);
    CHECK(largest_difference(both.R_below, both.R_below.transpose()) < 1e-11);
    CHECK(largest_difference(both.D_down, both.D_up.transpose()) < 1e-11);
    CHECK(largest_difference(both.R_above, both.R_below) > 0.1);  // the two sides do differ
    const MatrixXd rho = reflectance_factors(grid, solver.over(upper, solver.half_space(white)));
    CHECK(largest_difference(rho, rho.transpose()) < 1e-11);
}

TEST_CASE("One slab is sixteen slabs") {
    const AddingDoubling solver = solver_looking_along(1.5, 0.4, 6, 6, {1.0}, 24);
    const Medium medium{0.3, 5.7};
    const LayerResponse whole = solver.layer(medium, 1.0), slice = solver.layer(medium, 1.0 / 16);
    LayerResponse pile = slice;
    for (int k = 1; k < 16; ++k) pile = solver.add(pile, slice);
    CHECK(largest_difference(pile.R_above, whole.R_above) < 2e-7);
    CHECK(largest_difference(pile.R_below, whole.R_below) < 2e-7);
    CHECK(largest_difference(pile.D_down, whole.D_down) < 2e-7);
    CHECK(largest_difference(pile.D_up, whole.D_up) < 2e-7);
    CHECK((pile.direct - whole.direct).abs().maxCoeff() < 1e-12);
    CHECK(largest_difference(solver.over(whole, solver.half_space(medium)), solver.half_space(medium)) < 2e-7);
}

TEST_CASE("It does not matter which two of three layers are laid together first") {
    const AddingDoubling solver = solver_looking_along(1.5, 0.4, 6, 6, {1.0}, 24);
    // Three that differ, so that a pile of two is not the same from both sides.
    const LayerResponse cyan = solver.layer({1.35, 3.15}, 0.2), white = solver.layer({0.0027, 8.9973}, 0.1),
                        black = solver.layer({4, 1}, 0.05);
    const LayerResponse upper_first = solver.add(solver.add(cyan, white), black),
                        lower_first = solver.add(cyan, solver.add(white, black));
    CHECK(largest_difference(upper_first.R_above, lower_first.R_above) < 1e-12);
    CHECK(largest_difference(upper_first.R_below, lower_first.R_below) < 1e-12);
    CHECK(largest_difference(upper_first.D_down, lower_first.D_down) < 1e-12);
    CHECK(largest_difference(upper_first.D_up, lower_first.D_up) < 1e-12);
    CHECK((upper_first.direct - lower_first.direct).abs().maxCoeff() < 1e-15);
    const LayerResponse pile = solver.add(cyan, white);
    CHECK(largest_difference(pile.R_above, pile.R_below) > 0.1);
    CHECK(largest_difference(pile.D_down, pile.D_up) > 1e-3);
    // Turned over it is the same pile.
    const LayerResponse turned = solver.add(black, solver.add(white, cyan));
    CHECK(largest_difference(turned.R_above, lower_first.R_below) < 1e-12);
    CHECK(largest_difference(turned.R_below, lower_first.R_above) < 1e-12);
    CHECK(largest_difference(turned.D_down, lower_first.D_up) < 1e-12);
    CHECK(largest_difference(turned.D_up, lower_first.D_down) < 1e-12);
}
