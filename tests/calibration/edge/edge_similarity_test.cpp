// SPDX-License-Identifier: GPL-3.0-or-later
//
// Maps of the distance, similar media, and the page that shows them.
#include "calibration/edge/edge_similarity.h"

#include <cmath>
#include <memory>

#include <catch2/catch.hpp>

#include "calibration/edge/edge_fit_text.h"
#include "calibration/edge/edge_report.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

constexpr double truth_g = 0.4;
const EdgeMedium clear_one{4, 0.97, truth_g}, dense{9, 0.995, truth_g};

EdgeProfileTable small_table(const std::vector<double>& g) {
    EdgeDictionary dictionary;
    dictionary.grid.g = g;
    for (double s = 2; s < 16; s *= 1.3) dictionary.grid.sigma_t.push_back(s);
    dictionary.grid.paths = 1u << 13;
    for (std::size_t run = 0; run < dictionary.grid.runs(); ++run)
        dictionary.records.push_back(edge_record(dictionary.setup, dictionary.grid, run));
    return {std::make_shared<const EdgeDictionary>(dictionary), dictionary.setup};
}

// What the table itself has of a medium.
EdgeProfile profile_of(const EdgeProfileTable& table, const std::string& resin, std::size_t thickness,
                       const EdgeMedium& medium) {
    const EdgeSetup& setup = table.setup();
    EdgeProfile profile{resin, table.grid().thickness_mm[thickness], setup.positions(), {}, {}};
    const Eigen::MatrixXd see =
        optics::pixels_from_cells(table.geometry(), profile.x_mm, {setup.pitch_mm, setup.blur_mm, 1});
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::VectorXd seen = see * table.cells(thickness, c, medium);
        profile.value[c].assign(seen.begin(), seen.end());
        profile.error[c].assign(profile.value[c].size(), 0.001);
    }
    return profile;
}

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t times = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++times;
    return times;
}

}  // namespace

TEST_CASE("media that are similar to a fit lie where the distance is least at other g", "[edge]") {
    EdgeProfileTable table = small_table({0.2, 0.4, 0.6});
    table.prepare(truth_g, true);
    std::vector<EdgeProfile> profiles;
    for (std::size_t t = 0; t < 2; ++t) {
        profiles.push_back(profile_of(table, "A", t, clear_one));
        profiles.push_back(profile_of(table, "B", t, dense));
    }
    EdgeFitOptions options;
    options.mu_from = options.mu_to = 1;
    EdgeFit fit = fit_edges(profiles, table, options);
    CHECK(fit.resins[0].by_g.empty());
    const EdgeSimilarity found = edge_similarity(fit, profiles, table, options);
    REQUIRE(found.maps.size() == 2);
    for (std::size_t r = 0; r < 2; ++r) {
        const EdgeMedium& truth = r == 0 ? clear_one : dense;
        REQUIRE(fit.resins[r].by_g.size() == 3);
        for (std::size_t c = 0; c < 3; ++c) {
            REQUIRE(found.maps[r][c].size() == 3);
            for (const EdgeMap& map : found.maps[r][c]) {
                // Eqs. 4 and 5.
                CHECK(map.similar.sigma_t * (1 - map.similar.albedo) ==
                      Approx(truth.sigma_t * (1 - truth.albedo)).epsilon(0.01));
                CHECK(map.similar.sigma_t * map.similar.albedo * (1 - map.g) ==
                      Approx(truth.sigma_t * truth.albedo * (1 - truth_g)).epsilon(0.01));
                CHECK(map.at_fitted <= map.distance.minCoeff() + 1e-9);
                CHECK(map.at_fitted <= map.at_similar + 1e-9);
                if (map.g == truth_g) {
                    CHECK(map.at_fitted < 1e-4);
                    CHECK(map.fitted.sigma_t == Approx(truth.sigma_t).epsilon(0.005));
                } else {
                    CHECK(map.at_fitted > 1e-3);  // g is told, too
                    CHECK(map.fitted.sigma_t == Approx(map.similar.sigma_t).epsilon(0.12));
                    // Without similarity, the extinction of the fit would be off by as much as it predicts.
                    CHECK(std::abs(map.fitted.sigma_t / truth.sigma_t - 1) > 0.15);
                }
            }
            CHECK(found.agreement(r, c).ln_sigma_t < 0.1);
        }
    }
    const std::string page = edge_report_html(fit, profiles, table, options, found);
    CHECK(count(page, "<image ") == 2 * 3 * 3);  // maps
    CHECK(count(page, "<img ") == 2 * 2);        // slabs, measured above simulated
    CHECK_THAT(page, Contains(edge_fit_text(fit).substr(0, 20)));
    CHECK_THAT(page, Contains("Similar media") && Contains("neighbours") && Contains("g = 0.6"));
    CHECK_THAT(page, !Contains("nan") && !Contains("inf"));
}

TEST_CASE("g comes back from profiles, one for all resins or one for each", "[edge]") {
    static EdgeProfileTable table = [] {  // once for both sections
        EdgeProfileTable made = small_table({0.2, 0.3, 0.4, 0.5, 0.6});
        made.prepare(truth_g, true);
        return made;
    }();
    const auto measured = [&](double g_a, double g_b) {
        std::vector<EdgeProfile> profiles;
        for (std::size_t t = 0; t < 2; ++t) {
            profiles.push_back(profile_of(table, "A", t, {clear_one.sigma_t, clear_one.albedo, g_a}));
            profiles.push_back(profile_of(table, "B", t, {dense.sigma_t, dense.albedo, g_b}));
        }
        return profiles;
    };
    EdgeFitOptions options;
    options.mu_from = options.mu_to = 1;
    SECTION("shared") {
        options.anisotropy = EdgeAnisotropy::shared;
        for (const double g : {0.3, 0.44}) {
            const EdgeFit fit = fit_edges(measured(g, g), table, options);
            CHECK(fit.set.g == Approx(g).margin(0.03));
            CHECK(fit.resins[0].g == fit.set.g);
            CHECK(fit.set.resins[0].sigma_t_per_mm[1] == Approx(clear_one.sigma_t).epsilon(0.05));
            CHECK(fit.resins[1].by_g.size() == 5);
        }
    }
    SECTION("each, and brought to one g by similarity") {
        options.anisotropy = EdgeAnisotropy::each;
        const EdgeFit fit = fit_edges(measured(0.3, 0.5), table, options);
        CHECK(fit.set.g == truth_g);
        CHECK(fit.resins[0].g == Approx(0.3).margin(0.03));
        CHECK(fit.resins[1].g == Approx(0.5).margin(0.03));
        CHECK(fit.resins[0].g_error > 0);
        for (std::size_t c = 0; c < 3; ++c) {
            const double sigma_s = dense.sigma_t * dense.albedo * (1 - 0.5) / (1 - truth_g);
            const double found = fit.set.resins[1].sigma_t_per_mm[c] * fit.set.resins[1].albedo[c];
            CHECK(found == Approx(sigma_s).epsilon(0.05));
            CHECK(std::abs(found / (dense.sigma_t * dense.albedo) - 1) > 0.1);  // not as it was measured
        }
    }
}
