// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edges beside a chart. What edges see of a resin in R, G and B is found without the formula that the fit uses: the
// albedo that a thick piece shows there, and the extinction by which thin slabs upon black look most as they do.
#include "calibration/chart/edge_values.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/chart/chart_fit.h"
#include "calibration/patches/patch_model.h"
#include "tests/calibration/chart/chart_samples.h"

namespace voxtone::calibration {
namespace {

using Catch::Contains;

// The least of f in [low, high] by golden sections.
template <class Function>
double least_at(double low, double high, const Function& f) {
    const double part = 0.6180339887;
    for (int step = 0; step < 60; ++step) {
        const double a = high - part * (high - low), b = low + part * (high - low);
        (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
    }
    return (low + high) / 2;
}

ResinPrior seen_by_edges(const optics::ResinSet& set, double factor) {
    ResinPrior prior{"drawn.edge.json", set.g, set.eta, {}};
    const Eigen::Matrix3Xd seen = optics::linear_srgb_weights(set.channels);
    std::vector<Patch> slabs;
    for (const double thickness : {0.1, 0.2, 0.4, 8.0}) {
        Patch slab;
        slab.top = {{"R", 1}}, slab.backing = "black", slab.thickness_mm = thickness;
        slabs.push_back(slab);
    }
    PatchModelOptions options;
    options.g = set.g, options.eta = set.eta;
    const PatchModel model(slabs, {"R", "black"}, options);
    const optics::Medium black{100, 0};
    for (const optics::Resin& resin : set.resins) {
        Eigen::MatrixXd rho(slabs.size(), set.channels.size());
        for (std::size_t c = 0; c < set.channels.size(); ++c) {
            const std::vector<double> of = model.rho(std::array{resin.medium(c), black});
            for (std::size_t i = 0; i < of.size(); ++i) rho(i, c) = of[i];
        }
        ResinPrior::Resin& entry = prior.resins.emplace_back();
        entry.role = resin.role;
        for (Eigen::Index j = 0; j < 3; ++j) {
            const Eigen::VectorXd of = rho * seen.row(j).transpose();
            const auto slabs_of = [&](double v, double ln) {
                return model.rho(std::array{medium_of({v, ln}, set.g), black});
            };
            if (of[3] < 0.03) continue;  // the edges would doubt it
            const double v =
                least_at(0.01, 1, [&](double at) { return std::abs(slabs_of(at, std::log(10.0))[3] - of[3]); });
            const double ln = least_at(std::log(0.5), std::log(60.0), [&](double at) {
                const std::vector<double> now = slabs_of(v, at);
                double sum = 0;
                for (Eigen::Index i = 0; i < 3; ++i) sum += std::pow(now[static_cast<std::size_t>(i)] - of[i], 2);
                return sum;
            });
            PriorValue& value = entry.channel[static_cast<std::size_t>(j)];
            value.at = {v, ln + std::log(factor)};
            Eigen::Matrix2d covariance;
            covariance << 1e-4, 2e-4, 2e-4, 25e-4;
            value.precision = prior_precision(covariance, true, true);
        }
    }
    return prior;
}

// Mean of |ln| of white's scattering, fitted to true.
double lengths_off(const optics::ResinSet& fitted, const optics::ResinSet& truth, double factor) {
    double sum = 0;
    for (std::size_t c = 0; c < truth.channels.size(); ++c) {
        const auto of = [&](const optics::ResinSet& set) {
            return set.resins[static_cast<std::size_t>(set.find("W"))].medium(c).sigma_s;
        };
        sum += std::abs(std::log(of(fitted) / (factor * of(truth))));
    }
    return sum / static_cast<double>(truth.channels.size());
}

}  // namespace

TEST_CASE("Edges tell a chart's lengths in its own channels", "[slow]") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    const double factor = GENERATE(0.5, 1.0, 2.0);
    const PatchTable chart = testing::drawn_chart(truth, 120, 1, 0.03);
    ChartFitOptions options;
    options.name = "fitted", options.channels = 4, options.lengths_from = optics::vero_opaque();
    const ChartFit without = fit_chart(chart, options);
    options.edges = seen_by_edges(truth, factor);
    const ChartFit with = fit_chart(chart, options);
    CHECK(edge_values(options.edges, {"C", "K", "M", "W", "Y"}).size() == 9);
    CHECK(lengths_off(without.set, truth, factor) > 0.15);
    CHECK(lengths_off(with.set, truth, factor) < 0.05);
    CHECK(with.warnings.empty());
    CHECK(with.held_out.mean < 1.2 * without.held_out.mean + 0.1);
    CHECK(with.length_error.size() == 4);
    CHECK_THAT(with.set.source, Contains("drawn.edge.json"));
}

TEST_CASE("Edges that a chart contradicts are told, those of other resins refused", "[slow]") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    const PatchTable chart = testing::drawn_chart(truth, 60, 1, 0.03);
    ChartFitOptions options;
    options.name = "fitted", options.channels = 4, options.lengths_from = optics::vero_opaque();
    options.edges = seen_by_edges(truth, 1);
    for (ResinPrior::Resin& resin : options.edges.resins)
        if (resin.role == "W") resin.channel[1].at.v = 0.6;
    const ChartFit fit = fit_chart(chart, options);
    REQUIRE(!fit.warnings.empty());
    CHECK_THAT(fit.warnings.back(), Contains("disagree"));
    for (ResinPrior::Resin& resin : options.edges.resins) resin.role += "2";
    CHECK_THROWS_WITH(fit_chart(chart, options), Contains("know of no resin"));
}

}  // namespace voxtone::calibration
