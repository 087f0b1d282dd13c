// SPDX-License-Identifier: GPL-3.0-or-later
//
// The distance of profiles and what its minimum is uncertain by, against what happens when the data are moved.
#include "calibration/edge/edge_objective.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "calibration/edge/edge_fit.h"
#include "calibration/rehearsal/edge_simulation_job.h"
#include "calibration/resins/resin_coordinates.h"

using namespace voxtone;
using namespace voxtone::calibration;

namespace {

constexpr double g = 0.4;
constexpr std::size_t green = 1;

/// Extinctions around that of the tests' resin, slabs of 0.5 mm.
std::shared_ptr<const EdgeDictionary> dictionary(const EdgeSetup& setup) {
    static const auto made = [&] {
        EdgeDictionary all{setup, {}, {}};
        all.grid.thickness_mm = {0.5};
        for (double s = 3; s < 12; s *= 1.18) all.grid.sigma_t.push_back(s);
        all.grid.paths = 1u << 16;
        for (std::size_t run = 0; run < all.grid.runs(); ++run)
            all.records.push_back(edge_record(setup, all.grid, run));
        return std::make_shared<const EdgeDictionary>(std::move(all));
    }();
    return made;
}

EdgeProfileTable table_of(const EdgeSetup& setup) {
    EdgeProfileTable table(dictionary(setup), setup);
    table.prepare(g, false);
    return table;
}

EdgeObjective objective_of(const EdgeProfile& slab, const EdgeProfileTable& table) {
    std::vector<std::string> why;
    return {edge_observations({&slab}, green, table, {}, why), green, table, {}};
}

/// The paper's bench, where nothing is uncertain.
EdgeSetup sure() {
    EdgeSetup setup;
    setup.thickness_error = setup.gel_error_mm = setup.level_error = 0;
    return setup;
}

/// Of a light resin, whose profile tells both of its values, rendered path by path; in the other channels, which nobody
/// looks at, it is dark, and paths end soon.
constexpr double sigma_t = 6, albedo = 0.985;
const EdgeProfile& rendered(double thickness_mm) {
    const auto make = [](double thickness) {
        EdgeBench bench;
        bench.noise = 0, bench.paths = 1u << 18;
        const optics::ResinSet set{"one", "",  {},
                                   g,     1.5, {{"Resin", "W", {sigma_t, sigma_t, sigma_t}, {0.01, albedo, 0.01}}}};
        return simulate_edge_profiles(set, EdgeSetup{}, {thickness}, bench).front();
    };
    static const EdgeProfile half = make(0.5), thicker = make(0.53);
    return thickness_mm == 0.5 ? half : thicker;
}

}  // namespace

TEST_CASE("a slab all of whose lengths are stretched looks the same, stretched, where it scatters as much less",
          "[edge]") {
    EdgeSetup setup;
    setup.blur_mm = 0;
    const EdgeProfileTable table = table_of(setup);
    EdgeProfile slab{"W", 0.5, {}, {}, {}}, stretched = slab;
    constexpr double k = 1.06;
    stretched.thickness_mm *= k;
    for (int i = -60; i <= 60; ++i) slab.x_mm.push_back(0.05 * i), stretched.x_mm.push_back(k * 0.05 * i);
    for (EdgeProfile* const one : {&slab, &stretched})
        for (std::size_t c = 0; c < 3; ++c) one->value[c].assign(slab.x_mm.size(), 0.5);
    const EdgeObjective of = objective_of(slab, table), of_stretched = objective_of(stretched, table);
    const EdgePoint p(v_of_albedo(albedo, g), std::log(sigma_t)), scaled = p - EdgePoint(0, std::log(k));
    const Eigen::VectorXd seen = of.simulated(of.slabs()[0], p, g);
    CHECK((of_stretched.simulated(of_stretched.slabs()[0], scaled, g) - seen).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((of_stretched.simulated(of_stretched.slabs()[0], p, g) - seen).cwiseAbs().maxCoeff() > 0.003);
    // What can be searched is what the dictionary has at that thickness.
    CHECK(of_stretched.least()[1] == Approx(of.least()[1] - std::log(k)));
    CHECK(of_stretched.most()[1] == Approx(of.most()[1] - std::log(k)));
}

TEST_CASE("a slab of 0.53 mm that says so is fitted with a dictionary of 0.5 mm", "[edge]") {
    const EdgeProfileTable table = table_of({});
    EdgeProfile slab = rendered(0.53);
    const auto fitted = [&] { return objective_of(slab, table).minimum(g, 1); };
    const EdgeObjective::Minimum said = fitted();
    INFO("sigma_t " << std::exp(said.at[1]) << " for " << sigma_t);
    // Within a third of what the thickness is worth.
    CHECK(std::abs(said.at[1] - std::log(sigma_t)) < std::log(1.06) / 3);
    slab.thickness_mm = 0.5;
    CHECK(fitted().at[1] - said.at[1] == Approx(std::log(1.06)).epsilon(1.0 / 3));
}

TEST_CASE("each part of a fit's error is how far the minimum goes when what it stands for is off by as much",
          "[edge]") {
    const EdgeProfile& slab = rendered(0.5);
    const EdgeProfileTable table = table_of(sure());
    const EdgeObjective objective = objective_of(slab, table);
    const EdgeObjective::Minimum at = objective.minimum(g, 1);
    const Eigen::Matrix2d noise = objective.covariance(at, g, 1, 0);
    // The part that a setup has and another has not, as errors of v and ln sigma_t.
    const auto part = [&](const EdgeSetup& setup, double mu_error = 0) {
        const EdgeProfileTable unsure = table_of(setup);
        return EdgePoint(
            (objective_of(slab, unsure).covariance(at, g, 1, mu_error) - noise).diagonal().cwiseMax(0).cwiseSqrt());
    };
    const auto moved = [&](const EdgeProfile& other, const EdgeProfileTable& by, double mu = 1) {
        return EdgePoint((objective_of(other, by).minimum_from(at.at, g, mu).at - at.at).cwiseAbs());
    };
    const auto compare = [](const char* what, const EdgePoint& told, const EdgePoint& is) {
        INFO(what << ": told " << told.transpose() << ", moved by " << is.transpose());
        CHECK(is.norm() > 1e-4);
        // To first order; small errors, so that the second counts little.
        for (int k = 0; k < 2; ++k) CHECK(told[k] == Approx(is[k]).epsilon(0.05).margin(0.01 * is.norm()));
    };
    EdgeSetup setup = sure();
    setup.level_error = 0.003;
    EdgeProfile brighter = slab;
    for (double& v : brighter.value[green]) v *= 1.003;
    compare("level", part(setup), moved(brighter, table));
    setup = sure();
    setup.thickness_error = 0.01;
    EdgeProfile thicker = slab;
    thicker.thickness_mm *= 1.01;
    compare("thickness", part(setup), moved(thicker, table));
    compare("mu", part(sure(), 0.003), moved(slab, table, 1.003));
    // Gel that is thicker than assumed blurs what is seen through it.
    setup = sure();
    setup.gel_error_mm = 0.04;
    EdgeSetup softer = sure();
    softer.blur_mm = 0.04;
    compare("gel", part(setup), moved(slab, table_of(softer)));
    // Together they add up as independent errors do.
    setup.level_error = 0.003, setup.thickness_error = 0.01;
    EdgePoint sum = EdgePoint::Zero();
    EdgeSetup level = sure(), thickness = sure(), gel = sure();
    level.level_error = 0.003, thickness.thickness_error = 0.01, gel.gel_error_mm = 0.04;
    for (const EdgeSetup& one : {level, thickness, gel}) sum += part(one).cwiseAbs2();
    CHECK((part(setup).cwiseAbs2() - sum).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("errors of a fit do not hang on the order of its slabs", "[edge]") {
    const EdgeProfileTable table = table_of(sure());
    EdgeProfile brighter = rendered(0.5), darker = rendered(0.5), steeper = rendered(0.5);
    for (double& v : brighter.value[green]) v *= 1.01;
    for (double& v : darker.value[green]) v *= 0.995;
    for (double& v : steeper.value[green]) v = std::pow(v, 1.02);
    std::vector<std::string> why;
    const auto covariance = [&](const std::vector<const EdgeProfile*>& slabs) {
        const EdgeObjective objective(edge_observations(slabs, green, table, {}, why), green, table, {});
        return objective.covariance(objective.minimum(g, 1), g, 1, 0);
    };
    const Eigen::Matrix2d first = covariance({&brighter, &darker, &steeper});
    CHECK((covariance({&steeper, &brighter, &darker}) - first).norm() < 1e-3 * first.norm());
    CHECK((covariance({&darker, &steeper, &brighter}) - first).norm() < 1e-3 * first.norm());
    // That they disagree is an error of its own.
    CHECK(first.trace() > 1.05 * covariance({&brighter, &brighter, &brighter}).trace());
}

TEST_CASE("the error of mu is that of leaving one resin out after the other", "[edge]") {
    const EdgeSetup setup = sure();
    optics::ResinSet set{"three", "", {}, g, 1.5, {}};
    for (const auto& [role, extinction, light] :
         {std::tuple{"A", 5.0, 0.9}, std::tuple{"B", 6.0, 0.985}, std::tuple{"D", 7.0, 0.96}})
        set.resins.push_back({role, role, {extinction, extinction, extinction}, {light, light, light}});
    EdgeBench bench;
    bench.noise = 0, bench.paths = 1u << 15;
    std::vector<EdgeProfile> profiles = simulate_edge_profiles(set, setup, {0.5}, bench);
    for (std::size_t k = 0; k < 3; ++k)  // photographs that were not lit alike
        for (auto& channel : profiles[k].value)
            for (double& v : channel) v *= 0.94 + 0.06 * double(k);
    EdgeProfileTable table = table_of(setup);
    const auto fitted = [&](const std::vector<EdgeProfile>& some) { return fit_edges(some, table, {}); };
    const EdgeFit fit = fitted(profiles);
    double sum = 0, squares = 0;
    for (std::size_t out = 0; out < 3; ++out) {
        std::vector<EdgeProfile> others = profiles;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(out));
        const double mu = fitted(others).mu;
        sum += mu, squares += mu * mu;
    }
    const double jackknife = std::sqrt(2.0 / 3 * (squares - sum * sum / 3));
    // Besides, what the dictionary's noise makes of the level of one profile in the middle of all, of three resins.
    std::vector<double> grain;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& value = profiles[r].value[c];
            grain.push_back(table.noise(0, edge_medium(fit.resins[r].channel[c].at, g)) /
                            (std::accumulate(value.begin(), value.end(), 0.0) / double(value.size())));
        }
    std::ranges::sort(grain);
    const double expected = std::hypot(jackknife, grain[4] / std::sqrt(3.0));
    INFO("mu " << fit.mu << " +- " << fit.mu_error << " for " << expected << ", jackknife " << jackknife);
    CHECK(jackknife > 0.6 * expected);
    CHECK(fit.mu_error == Approx(expected).epsilon(0.05));
}
