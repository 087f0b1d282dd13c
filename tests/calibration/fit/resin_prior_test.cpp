// SPDX-License-Identifier: GPL-3.0-or-later
//
// Patches beside what was known before: together they are better than either, and they disagree aloud.
#include "calibration/resins/resin_prior.h"

#include <cmath>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/fit/resin_fit.h"
#include "tests/calibration/patches/target_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> colours{"C", "M", "Y"};
constexpr double v_error = 0.004, ln_error = 0.05, leaning = 0.5;  // of the prior; its correlation

// Vero as it might have been measured before, off by normal errors that it states.
ResinPrior known_before(std::uint64_t seed, double factor = 1) {
    ResinPrior prior{"before", 0.4, 1.5, {}};
    Eigen::Matrix2d covariance;
    covariance << v_error * v_error, leaning * v_error * ln_error, leaning * v_error * ln_error, ln_error * ln_error;
    const optics::ResinSet vero = optics::vero_opaque();
    for (std::size_t r = 0; r < vero.resins.size(); ++r) {
        ResinPrior::Resin& entry = prior.resins.emplace_back();
        entry.role = vero.resins[r].role;
        for (std::size_t c = 0; c < 3; ++c) {
            const double a = normal(seed + 1000, 100 * r + 10 * c), b = normal(seed + 1000, 100 * r + 10 * c + 1);
            const double v = v_of_albedo(vero.resins[r].albedo[c], 0.4) + factor * v_error * a;
            const double ln = std::log(vero.resins[r].sigma_t_per_mm[c]) +
                              factor * ln_error * (leaning * a + std::sqrt(1 - leaning * leaning) * b);
            entry.channel[c] = {clamped({v, ln}, resin_bounds(0.4)), prior_precision(covariance, true, true)};
        }
    }
    return prior;
}

struct Squares {
    double v = 0, ln = 0;
    int values = 0;
};

// Away from the truth, summed over resins and channels.
void add(Squares& sum, const optics::ResinSet& set) {
    const optics::ResinSet truth = optics::vero_opaque();
    for (const optics::Resin& resin : truth.resins)
        for (std::size_t c = 0; c < 3; ++c) {
            const optics::Resin& found = set.resins[static_cast<std::size_t>(set.find(resin.role))];
            sum.v += std::pow(v_of_albedo(found.albedo[c], 0.4) - v_of_albedo(resin.albedo[c], 0.4), 2);
            sum.ln += std::pow(std::log(found.sigma_t_per_mm[c] / resin.sigma_t_per_mm[c]), 2);
            ++sum.values;
        }
}

std::string edge_json(const std::string& sigma_doubts, const std::string& more = {}) {
    const std::string channel = fmt::format(
        R"({{"channel": "R", "sigma_t_per_mm": {{"value": 5, "doubts": [{}]}}, "albedo": {{"value": 0.9, "doubts": []}},
            "covariance_v_ln_sigma_t": [1e-4, 1e-4, 4e-4]{}}})",
        sigma_doubts, more);
    return fmt::format(
        R"({{"format": "voxtone-edge-fit", "version": 1, "g": 0.3, "eta": 1.48,
            "resins": [{{"role": "C", "channels": [{0}, {0}, {0}]}}]}})",
        channel);
}

}  // namespace

TEST_CASE("patches and a prior together are better than either, with errors that hold", "[prior]") {
    constexpr int seeds = 12;
    const optics::ResinSet vero = optics::vero_opaque();
    Squares patches, before, both;
    int within_one = 0, within_two = 0, values = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        PatchTable table = target('B', colours);
        measure(table, optics::vero_opaque(), 0.005, static_cast<std::uint64_t>(seed));
        FitOptions options;
        add(patches, fit_resins(table, options).set);
        options.prior = known_before(static_cast<std::uint64_t>(seed));
        optics::ResinSet set = optics::vero_opaque();
        for (std::size_t r = 0; r < set.resins.size(); ++r)
            for (std::size_t c = 0; c < 3; ++c) {
                const ResinPoint& at = options.prior.resins[r].channel[c].at;
                set.resins[r].albedo[c] = albedo_of_v(at.v, 0.4);
                set.resins[r].sigma_t_per_mm[c] = std::exp(at.ln_sigma_t);
            }
        add(before, set);
        const ResinFit fit = fit_resins(table, options);
        CHECK(fit.warnings.empty());
        add(both, fit.set);
        for (const FittedResin& resin : fit.resins)
            for (std::size_t c = 0; c < 3; ++c) {
                const optics::Resin& truth = vero.resins[static_cast<std::size_t>(vero.find(resin.role))];
                const double z = std::abs(std::log(resin.sigma_t[c].value / truth.sigma_t_per_mm[c])) /
                                 (resin.sigma_t[c].standard_error / resin.sigma_t[c].value);
                within_one += z < 1, within_two += z < 2, ++values;
            }
    }
    INFO("v: patches " << std::sqrt(patches.v / patches.values) << ", prior " << std::sqrt(before.v / before.values)
                       << ", both " << std::sqrt(both.v / both.values) << "; ln sigma_t "
                       << std::sqrt(patches.ln / patches.values) << ", " << std::sqrt(before.ln / before.values) << ", "
                       << std::sqrt(both.ln / both.values));
    CHECK(both.v < 0.9 * std::min(patches.v, before.v));
    CHECK(both.ln < 0.9 * std::min(patches.ln, before.ln));
    // 180 values: 68.3 and 95.4 % within one and two errors, four standard deviations to either side.
    CHECK(std::abs(within_one - 0.683 * values) < 4 * std::sqrt(0.683 * 0.317 * values));
    CHECK(std::abs(within_two - 0.954 * values) < 4 * std::sqrt(0.954 * 0.046 * values));
}

TEST_CASE("a prior whose errors are five times what it says is told", "[prior]") {
    PatchTable table = target('B', colours);
    measure(table, optics::vero_opaque(), 0.005, 3);
    FitOptions options;
    options.prior = known_before(3, 5);
    const ResinFit fit = fit_resins(table, options);
    REQUIRE_FALSE(fit.warnings.empty());
    CHECK_THAT(fit.warnings.front(), Contains("the patches want other values than before has"));
}

TEST_CASE("a resin of the prior that has no patch is taken as it is there", "[prior]") {
    PatchTable table = target('B', {"C", "M"});
    measure(table, optics::vero_opaque(), 0.005, 3);
    FitOptions options;
    options.prior = known_before(3);
    const ResinFit fit = fit_resins(table, options);
    REQUIRE(fit.set.find("Y") >= 0);
    const optics::Resin& yellow = fit.set.resins[static_cast<std::size_t>(fit.set.find("Y"))];
    const ResinPoint& at = options.prior.find("Y")->channel[1].at;
    CHECK(yellow.sigma_t_per_mm[1] == Approx(std::exp(at.ln_sigma_t)));
    CHECK(yellow.albedo[1] == Approx(albedo_of_v(at.v, 0.4)));
    const FittedValue& value = fit.resins.back().sigma_t[1];
    CHECK(value.standard_error == Approx(value.value * ln_error).epsilon(0.01));
    // sigma_t (1 - g albedo), where it is dark: by both of its values, which lean on each other.
    const ResinPoint& dark = options.prior.find("Y")->channel[2].at;
    const FittedValue& told = fit.resins.back().reduced[2];
    const auto reduced = [&](double v, double ln) {
        return std::exp(dark.ln_sigma_t + ln) * (1 - 0.4 * albedo_of_v(dark.v + v, 0.4));
    };
    const double by_v = (reduced(v_error, 0) - reduced(-v_error, 0)) / 2,
                 by_ln = (reduced(0, ln_error) - reduced(0, -ln_error)) / 2,
                 error = std::sqrt(by_v * by_v + by_ln * by_ln + 2 * leaning * by_v * by_ln);
    CHECK(told.value == Approx(reduced(0, 0)));
    CHECK(told.standard_error == Approx(error).epsilon(0.005));
    CHECK(error > 1.02 * by_ln);  // more than that of the extinction alone
}

TEST_CASE("edge results are read as a prior, without what they doubt", "[prior]") {
    const ResinPrior told = parse_resin_prior(edge_json(""), "x");
    CHECK(told.g == 0.3);
    CHECK(told.eta == 1.48);
    const PriorValue& value = told.find("C")->channel[0];
    CHECK(value.known() == 2);
    CHECK(value.at.v == Approx(v_of_albedo(0.9, 0.3)));
    CHECK(value.at.ln_sigma_t == Approx(std::log(5)));
    const Eigen::Matrix2d back = value.precision.inverse();
    CHECK(back(0, 1) == Approx(1e-4));
    CHECK(back(1, 1) == Approx(4e-4));
    const PriorValue opaque = parse_resin_prior(edge_json("\"opaque\""), "x").resins[0].channel[2];
    CHECK(opaque.known() == 1);
    CHECK(opaque.precision(0, 0) == Approx(1e4));
    CHECK(opaque.precision(1, 1) == 0);
    // Completed by a chart: as the edges had it.
    const PriorValue completed =
        parse_resin_prior(edge_json("", R"(, "edges": {"sigma_t_per_mm": {"value": 30, "doubts": ["opaque"]},
                                               "albedo": {"value": 0.8, "doubts": []}})"),
                          "x")
            .resins[0]
            .channel[0];
    CHECK(completed.known() == 1);
    CHECK(completed.at.v == Approx(v_of_albedo(0.8, 0.3)));
    CHECK_THROWS_WITH(parse_resin_prior(R"({"format": "voxtone-fit"})", "x"), Contains("NAME.edge.json"));
    CHECK_THROWS_AS(parse_resin_prior(R"({"format": "voxtone-edge-fit", "g": 0.4, "resins": []})", "x"), InputError);
}
