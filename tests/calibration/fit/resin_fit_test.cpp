// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/resin_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/fit/channel_fit.h"
#include "calibration/fit/fit_report.h"
#include "calibration/fit/fit_text.h"
#include "calibration/fit/patch_page.h"
#include "calibration/fit/principles.h"
#include "calibration/patches/patch_file.h"
#include "io/files/markup.h"
#include "tests/calibration/patches/target_samples.h"
#include "tests/optics/colour/split_channels.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> colours{"C", "M", "Y"};

PatchTable measured(char layout, double noise, std::uint64_t seed = 1,
                    const optics::ResinSet& truth = optics::vero_opaque()) {
    PatchTable table = target(layout, colours);
    measure(table, truth, noise, seed);
    return table;
}

// Largest relative error of all albedos and extinctions.
double worst_error(const ResinFit& fit, const optics::ResinSet& truth) {
    double worst = 0;
    for (const auto& resin : truth.resins) {
        const int at = fit.set.find(resin.role);
        REQUIRE(at >= 0);
        const auto& found = fit.set.resins[static_cast<std::size_t>(at)];
        for (std::size_t c = 0; c < truth.channels.size(); ++c) {
            worst = std::max(worst, std::abs(found.albedo[c] / resin.albedo[c] - 1));
            worst = std::max(worst, std::abs(found.sigma_t_per_mm[c] / resin.sigma_t_per_mm[c] - 1));
        }
    }
    return worst;
}

const FittedResin& resin_of(const ResinFit& fit, const std::string& role) {
    return fit.resins[static_cast<std::size_t>(fit.set.find(role))];
}

bool has(const FittedValue& value, Doubt doubt) { return std::ranges::find(value.doubts, doubt) != value.doubts.end(); }

std::string fault(const PatchTable& table, const FitOptions& options = {}) {
    try {
        (void)fit_resins(table, options);
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL("accepted");
    return {};
}

void erase(PatchTable& table, const std::function<bool(const Patch&)>& which) { std::erase_if(table.patches, which); }

bool is(const Patch& patch, const std::string& top, const std::string& backing) {
    return patch.top.size() == 1 && patch.top[0].role == top && patch.backing == backing;
}

bool contains(const Patch& patch, const std::string& role) {
    return std::ranges::any_of(patch.top, [&](const ResinShare& s) { return s.role == role; });
}

// All 121 mixtures of the five resins in steps of 20 %, each on both bases, without values.
PatchTable other_mixtures() {
    const std::vector<std::string> roles{"C", "M", "Y", "K", "W"};
    PatchTable table;
    for (int code = 0; code < 6 * 6 * 6 * 6; ++code) {
        std::array<int, 5> fifths{code % 6, code / 6 % 6, code / 36 % 6, code / 216, 0};
        fifths[4] = 5 - fifths[0] - fifths[1] - fifths[2] - fifths[3];
        if (fifths[4] < 0 || std::ranges::count(fifths, 5) > 0) continue;
        Patch patch;
        for (std::size_t r = 0; r < roles.size(); ++r)
            if (fifths[r] > 0) patch.top.push_back({roles[r], fifths[r] / 5.0});
        patch.thickness_mm = 0.675;
        for (const char* base : {"W", "K"}) patch.backing = base, table.patches.push_back(patch);
    }
    return table;
}

// A set as far from the truth as the noise of a target must leave an efficient estimator: drawn from the Cramer-Rao
// covariance at the truth.
optics::ResinSet efficient_estimate(const PatchTable& exact, double noise, std::uint64_t seed) {
    const TargetRoles roles = find_target_roles(exact, {}, noise);
    const ChannelFitter fitter(exact, roles, {}, noise);
    const ResinBounds bounds = resin_bounds(0.4);
    optics::ResinSet set = optics::vero_opaque();
    for (std::size_t c = 0; c < 3; ++c) {
        const ChannelFit truth = fitter.fit(c);
        const Eigen::MatrixXd root = truth.covariance.llt().matrixL();
        Eigen::VectorXd drawn(root.rows());
        for (Eigen::Index k = 0; k < drawn.size(); ++k)
            drawn[k] = normal(seed, 1000 * (c + 1) + static_cast<std::uint64_t>(k));
        drawn = root * drawn;
        for (std::size_t r = 0; r < roles.roles.size(); ++r) {
            const auto k = static_cast<Eigen::Index>(2 * r);
            const ResinPoint at =
                clamped({truth.resins[r].v + drawn[k], truth.resins[r].ln_sigma_t + drawn[k + 1]}, bounds);
            optics::Resin& resin = set.resins[static_cast<std::size_t>(set.find(roles.roles[r]))];
            resin.albedo[c] = albedo_of_v(at.v, 0.4), resin.sigma_t_per_mm[c] = std::exp(at.ln_sigma_t);
        }
    }
    return set;
}

}  // namespace

TEST_CASE("Target B without noise gives back every value of the Vero set") {
    const PatchTable table = measured('B', 0);
    const ResinFit fit = fit_resins(table, {});
    CHECK(worst_error(fit, optics::vero_opaque()) < 1e-3);
    CHECK(fit.patches.differences.max < 1e-3);
    CHECK(fit.misfit.empty());
    CHECK(fit.set.channels.is_rgb());
}

TEST_CASE("A base of 5 mm that is said to be one gives back the set, one that is not gives white that is too dark") {
    PatchTable table = target('B', colours, "W", "K", 5);
    measure(table, optics::vero_opaque(), 0, 1);
    CHECK(worst_error(fit_resins(table, {}), optics::vero_opaque()) < 1e-3);
    for (Patch& patch : table.patches) patch.base_mm = 0;
    const ResinFit blind = fit_resins(table, {});
    CHECK(resin_of(blind, "W").albedo[0].value < 0.9991 - 1e-4);
}

TEST_CASE("Halftoned mixtures are fitted as halftones, and their bias shows where they are taken as ideal") {
    PatchTable table = target('B', colours);
    FitOptions options;
    options.model.pitch_mm = {0.0423, 0.0847, 0.027};
    measure(table, optics::vero_opaque(), 0, 1, options.model);
    const ResinFit sharp = fit_resins(table, options), ideal = fit_resins(table, {});
    CHECK(worst_error(sharp, optics::vero_opaque()) < 1e-3);
    CHECK(worst_error(ideal, optics::vero_opaque()) > 0.05);
    // Each set says how its mixtures were taken, for whoever slices with it.
    CHECK(sharp.set.dot_spread == 0);
    CHECK(ideal.set.dot_spread == 1);
    options.model.dot_spread = 0.6;
    measure(table, optics::vero_opaque(), 0, 1, options.model);
    const ResinFit between = fit_resins(table, options);
    CHECK(worst_error(between, optics::vero_opaque()) < 1e-3);
    CHECK(between.set.dot_spread == 0.6);
}

TEST_CASE("A target's own mixtures tell how far droplets ran together", "[slow]") {
    const double spread = GENERATE(0.0, 0.4, 1.0);
    FitOptions options;
    options.model.pitch_mm = {0.0423, 0.0847, 0.027};
    options.fit_dot_spread = true;
    options.noise = 0.0005;
    PatchModelOptions printed = options.model;
    printed.dot_spread = spread;
    PatchTable table = target('C', colours);
    measure(table, optics::vero_opaque(), options.noise, 1, printed);
    const ResinFit fit = fit_resins(table, options);
    CAPTURE(spread, fit.set.dot_spread, fit.dot_spread_error);
    CHECK(fit.warnings.empty());
    CHECK(fit.dot_spread_error > 0);
    CHECK(fit.dot_spread_error < 0.15);
    CHECK(fit.set.dot_spread == Approx(spread).margin(3 * fit.dot_spread_error));
    CHECK_THAT(fit_text(fit, table), Contains("Dot spread "));
    // One that is given is not fitted.
    options.fit_dot_spread = false, options.model.dot_spread = 0.5;
    const ResinFit given = fit_resins(table, options);
    CHECK(given.set.dot_spread == 0.5);
    CHECK(given.dot_spread_error == 0);
    CHECK_THAT(fit_text(given, table), !Contains("Dot spread"));
}

TEST_CASE("Where noise hides how far droplets ran together, or no square is a mixture, that is said", "[slow]") {
    FitOptions options;
    options.model.pitch_mm = {0.0423, 0.0847, 0.027};
    options.fit_dot_spread = true;
    PatchModelOptions printed = options.model;
    printed.dot_spread = GENERATE(0.0, 1.0);
    for (const char layout : {'A', 'C'}) {
        options.noise = layout == 'A' ? 0.0005 : 0.02;
        PatchTable table = target(layout, colours);
        measure(table, optics::vero_opaque(), options.noise, 1, printed);
        const ResinFit fit = fit_resins(table, options);
        CAPTURE(printed.dot_spread, layout, fit.set.dot_spread);
        CHECK(fit.set.dot_spread == 0);
        CHECK(fit.dot_spread_error == 0);
        REQUIRE(fit.warnings.size() == 1);
        CHECK_THAT(fit.warnings[0], Contains("cannot be told") && Contains("[assumed]") &&
                                        Contains(layout == 'A' ? "no square holds a mixture" : "nearly as well"));
    }
}

TEST_CASE("Another phase function and index in both, and wavelengths instead of colours, give back the set") {
    optics::ResinSet truth = optics::vero_opaque();
    truth.g = 0.1, truth.eta = 1.4;
    truth.channels.wavelengths_nm = {450, 550, 610};
    FitOptions options;
    options.model.g = truth.g, options.model.eta = truth.eta;
    const ResinFit fit = fit_resins(measured('B', 0, 1, truth), options);
    CHECK(worst_error(fit, truth) < 1e-3);
    CHECK(fit.set.g == 0.1);
    CHECK(fit.set.channels == truth.channels);
}

TEST_CASE("Mixtures that were not in the fit are predicted as well as the noise of target B allows", "[slow]") {
    const optics::ResinSet truth = optics::vero_opaque();
    PatchTable others = other_mixtures();
    REQUIRE(others.patches.size() == 242);
    measure(others, truth, 0, 1);
    const PatchTable exact = measured('B', 0);
    const int seeds = 12;
    const auto mean_difference = [&](double noise) {
        double sum = 0;
        FitOptions options;
        options.noise = noise;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed)
            sum += check_resins(fit_resins(measured('B', noise, seed), options).set, others, {}).differences.mean;
        return sum / seeds;
    };
    double bound = 0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
        bound += check_resins(efficient_estimate(exact, 0.005, seed), others, {}).differences.mean / seeds;
    const double noisy = mean_difference(0.005);
    INFO("mean CIEDE2000 " << noisy << " at noise 0.005, of an efficient estimator " << bound);
    CHECK(noisy < 1.2 * bound);
    CHECK(mean_difference(0.002) < 0.5);
    // The test can fail: extinctions that are 30 % off are seen.
    optics::ResinSet wrong = truth;
    for (auto& resin : wrong.resins)
        if (resin.role != "W")
            for (double& s : resin.sigma_t_per_mm) s *= 1.3;
    CHECK(check_resins(wrong, others, {}).differences.mean > 1.2 * bound);
}

TEST_CASE("The same values come out for any number of threads") {
    const PatchTable table = measured('B', 0.005);
    const auto values = test::same_for_threads([&] {
        std::vector<std::vector<double>> all;
        for (const optics::Resin& resin : fit_resins(table, {}).set.resins)
            all.insert(all.end(), {resin.albedo, resin.sigma_t_per_mm});
        return all;
    });
    CHECK(values.size() == 10);
}

TEST_CASE("The Principles alone come near in target B, and their errors are the joint fit's to mend") {
    const PatchTable table = measured('B', 0);
    const TargetRoles roles = find_target_roles(table, {}, 0.005);
    CHECK(roles.roles == std::vector<std::string>{"W", "K", "C", "M", "Y"});
    const ChannelStart start = Principles(table, roles, {}, 0.005).start(1);
    const auto albedo = [&](std::size_t r) { return albedo_of_v(start.resins[r].v, 0.4); };
    const auto sigma_t = [&](std::size_t r) { return std::exp(start.resins[r].ln_sigma_t); };
    CHECK(albedo(0) == Approx(0.9997).margin(2e-5));
    CHECK(albedo(1) == Approx(0.35).margin(0.01));
    CHECK(sigma_t(0) == Approx(9).epsilon(0.1));
    CHECK(sigma_t(1) == Approx(5.5).epsilon(0.2));
    CHECK(albedo(2) == Approx(0.7).margin(0.05));
    CHECK(sigma_t(2) == Approx(4.5).epsilon(0.2));
    CHECK(albedo(4) == Approx(0.995).margin(0.002));
    CHECK(sigma_t(4) == Approx(3.75).epsilon(0.2));
}

TEST_CASE("Light and dark grey do in place of white and black, under any name") {
    optics::ResinSet truth = optics::vero_opaque();
    truth.resins[3] = {"dark", "dark", {5, 5, 5}, {0.9, 0.9, 0.9}};
    truth.resins[4] = {"light", "light", {5, 5, 5}, {0.99, 0.99, 0.99}};
    PatchTable table = target('B', colours, "light", "dark");
    measure(table, truth, 0, 1);
    CHECK(worst_error(fit_resins(table, {}), truth) < 1e-3);
    // The order of the rows does not say which is the lighter one.
    std::ranges::reverse(table.patches);
    CHECK(worst_error(fit_resins(table, {}), truth) < 1e-3);
}

TEST_CASE("Clear resin is taken as clear, and helps to thin others") {
    optics::ResinSet truth = optics::vero_opaque();
    truth.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    PatchTable table = target('B', colours);
    for (const char* base : {"W", "K"}) {
        table.patches.push_back({{{"T", 1}}, base, 0.675, 0, {}, {}, {}});
        table.patches.push_back({{{"T", 0.8}, {"Y", 0.2}}, base, 0.675, 0, {}, {}, {}});
    }
    measure(table, truth, 0, 1);
    const ResinFit fit = fit_resins(table, {});
    CHECK(resin_of(fit, "T").sigma_t[0].value == 0);
    CHECK(resin_of(fit, "T").albedo[0].value == 1);
    CHECK(has(resin_of(fit, "T").albedo[0], Doubt::assumed));
    fit.set.validate();
    CHECK(resin_of(fit, "Y").sigma_t[2].value == Approx(19).epsilon(1e-3));
}

TEST_CASE("What clear resin absorbs is fitted from squares that are deep enough", "[slow]") {
    optics::ResinSet truth = optics::vero_opaque();
    truth.resins.push_back({"clear", "T", {0.004, 0.02, 0}, {0, 0, 1}});
    PatchTable table = target('A', {"T"});
    for (const double mm : {5.0, 10.0}) table.patches.push_back({{{"T", 1}}, "W", mm, 0, {}, {}, {}});
    std::erase_if(truth.resins, [](const optics::Resin& r) { return r.role == "C" || r.role == "M" || r.role == "Y"; });
    measure(table, truth, 0, 1);
    const ResinFit exact = fit_resins(table, {});
    CHECK(resin_of(exact, "T").sigma_t[0].value == Approx(0.004).epsilon(0.01));
    CHECK(resin_of(exact, "T").sigma_t[1].value == Approx(0.02).epsilon(0.01));
    CHECK(resin_of(exact, "T").sigma_t[2].value < 1e-4);
    CHECK(exact.set.resins[static_cast<std::size_t>(exact.set.find("T"))].albedo[0] == 0);
    exact.set.validate();
    CHECK(resin_of(exact, "W").albedo[1].value == Approx(0.9997).margin(1e-5));
    // Noise: errors are as large as they are told, and what does not absorb is told so.
    int within = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        measure(table, truth, 0.005, seed);
        const FittedResin clear = resin_of(fit_resins(table, {}), "T");
        CHECK(clear.sigma_t[1].value == Approx(0.02).epsilon(0.15));
        within += clear.sigma_t[1].low < 0.02 && clear.sigma_t[1].high > 0.02;
        CHECK(clear.sigma_t[2].low == 0);
        CHECK(clear.sigma_t[2].high < 0.001);
    }
    CHECK(within >= 2);
}

TEST_CASE("A sound table is no misfit because some of its resins are opaque", "[slow]") {
    // Without noise the least squares are nothing; the limits of opaque resins, which stand 1 above them each, do not
    // count.
    FitOptions options;
    options.noise = 0.02;
    const ResinFit fit = fit_resins(measured('A', 0), options);
    CHECK(has(resin_of(fit, "M").sigma_t[2], Doubt::opaque));
    for (const double chi2 : fit.chi2) CHECK(chi2 < 0.1);
    CHECK(fit.misfit.empty());
}

TEST_CASE("Where the patches cannot tell, a flag says which value and why", "[slow]") {
    // Pure squares alone: opaque magenta (blue) and black, cyan that is black in red, yellow that is black in blue.
    const ResinFit a = fit_resins(measured('A', 0.005), {});
    CHECK(has(resin_of(a, "C").albedo[0], Doubt::dark));
    CHECK_FALSE(resin_of(a, "C").sigma_t[0].doubts.empty());
    CHECK(has(resin_of(a, "Y").albedo[2], Doubt::dark));
    CHECK_FALSE(resin_of(a, "Y").sigma_t[2].doubts.empty());
    const auto is_limit = [](const FittedValue& value, double truth) {
        return has(value, Doubt::opaque) && value.low == value.value && value.value < truth && value.high == 120;
    };
    CHECK(is_limit(resin_of(a, "M").sigma_t[2], 10));
    // What is well seen is not doubted.
    CHECK(resin_of(a, "W").albedo[1].doubts.empty());
    CHECK(resin_of(a, "W").sigma_t[1].doubts.empty());
    CHECK(resin_of(a, "Y").sigma_t[0].doubts.empty());
    // Diluted, the extinctions are known.
    const ResinFit b = fit_resins(measured('B', 0.005), {});
    CHECK(resin_of(b, "C").sigma_t[0].doubts.empty());
    CHECK(resin_of(b, "Y").sigma_t[2].doubts.empty());
    CHECK(resin_of(b, "K").sigma_t[1].doubts.empty());
    CHECK(resin_of(b, "M").sigma_t[2].doubts.empty());
    CHECK(has(resin_of(b, "C").albedo[0], Doubt::dark));

    optics::ResinSet thin = optics::vero_opaque();
    thin.resins[0].sigma_t_per_mm.assign(3, 0.1);
    thin.resins[0].albedo.assign(3, 0.9);
    const ResinFit t = fit_resins(measured('B', 0.005, 1, thin), {});
    for (std::size_t c = 0; c < 3; ++c)
        CHECK((has(resin_of(t, "C").albedo[c], Doubt::thin) && has(resin_of(t, "C").sigma_t[c], Doubt::thin)));
}

TEST_CASE("Residuals beyond the noise are reported and widen the errors") {
    PatchTable table = measured('B', 0.005);
    const ResinFit fine = fit_resins(table, {});
    CHECK(fine.misfit.empty());
    for (Patch& patch : table.patches)
        if (patch.top.size() == 2 && contains(patch, "Y")) patch.rho[0] += patch.backing == "W" ? 0.06 : -0.05;
    const ResinFit off = fit_resins(table, {});
    REQUIRE(off.misfit == std::vector<std::size_t>{0});
    CHECK(resin_of(off, "W").sigma_t[0].standard_error > 1.5 * resin_of(fine, "W").sigma_t[0].standard_error);
    CHECK(off.patches.rms > 2 * fine.patches.rms);
}

TEST_CASE("The error of the reduced coefficient is that of its two values and of how they go together") {
    const PatchTable table = measured('B', 0.005);
    const ResinFit fit = fit_resins(table, {});
    REQUIRE(fit.misfit.empty());
    const TargetRoles roles = find_target_roles(table, {}, 0.005);
    const ChannelFitter fitter(table, roles, {}, 0.005);
    const double g = fit.set.g;
    int correlated = 0, within = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const ChannelFit channel = fitter.fit(c);
        for (std::size_t r = 0; r < roles.roles.size(); ++r) {
            const ResinPoint& at = channel.resins[r];
            const FittedValue& reduced = resin_of(fit, roles.roles[r]).reduced[c];
            const auto of = [&](double v, double ln) { return std::exp(ln) * (1 - g * albedo_of_v(v, g)); };
            const double value = of(at.v, at.ln_sigma_t), step = 1e-5;
            const Eigen::Vector2d slope((of(at.v + step, at.ln_sigma_t) - of(at.v - step, at.ln_sigma_t)) / (2 * step),
                                        (of(at.v, at.ln_sigma_t + step) - of(at.v, at.ln_sigma_t - step)) / (2 * step));
            const auto i = static_cast<Eigen::Index>(2 * r);
            const Eigen::Matrix2d covariance = channel.covariance.block<2, 2>(i, i);
            const double error = std::sqrt(slope.dot(covariance * slope));
            INFO(roles.roles[r] << " in " << c << ": " << value << " +- " << error);
            CHECK(reduced.value == Approx(value));
            CHECK(reduced.standard_error == Approx(error).epsilon(1e-3));
            CHECK(reduced.low == Approx(value * std::exp(-error / value)).epsilon(1e-3));
            CHECK(reduced.high == Approx(value * std::exp(error / value)).epsilon(1e-3));
            // Away from what an albedo can be at most, extinctions lie within one error of their logarithm.
            const double v_error = channel.errors[r].v, ln_error = channel.errors[r].ln_sigma_t;
            const FittedValue& sigma_t = resin_of(fit, roles.roles[r]).sigma_t[c];
            if (std::min(at.v, 1 - at.v) > 3 * v_error && !channel.opaque[r]) {
                CHECK(sigma_t.low == Approx(sigma_t.value * std::exp(-ln_error)));
                CHECK(sigma_t.high == Approx(sigma_t.value * std::exp(ln_error)));
                ++within;
            }
            // As independent values, or going the other way, they would have another error.
            const double without = std::sqrt(slope.dot(covariance.diagonal().asDiagonal() * slope));
            correlated += std::abs(without / error - 1) > 0.03;
        }
    }
    CHECK(correlated >= 5);
    CHECK(within >= 8);
}

TEST_CASE("The limit of an opaque resin's extinction is where chi2 lies one above the least") {
    const PatchTable table = measured('A', 0.005);
    const FittedValue magenta = resin_of(fit_resins(table, {}), "M").sigma_t[2];
    REQUIRE(has(magenta, Doubt::opaque));
    // chi2 with that extinction held, by a prior that knows it and nothing else.
    const auto chi2 = [&](double sigma_t) {
        FitOptions options;
        options.prior = {"held", 0.4, 1.5, {{"M", {}}}};
        PriorValue& value = options.prior.resins[0].channel[2];
        value.at = {0.5, std::log(sigma_t)};
        value.precision(1, 1) = 1e10;
        return fit_resins(table, options).chi2[2];
    };
    double least = chi2(magenta.value);
    for (const double factor : {1.5, 2.0, 4.0}) least = std::min(least, chi2(factor * magenta.value));
    INFO("limit " << magenta.value << ", chi2 " << chi2(magenta.value) - least << " above the least, "
                  << chi2(0.9 * magenta.value) - least << " a tenth below it");
    // The limit is found to 3 %, the bases held.
    CHECK(chi2(magenta.value) < least + 1.1);
    CHECK(chi2(0.9 * magenta.value) > least + 0.9);
}

TEST_CASE("Errors given with the patches weigh them") {
    PatchTable table = measured('B', 0.005);
    const ResinFit even = fit_resins(table, {});
    for (Patch& patch : table.patches) patch.error.assign(3, 0.01);
    CHECK(resin_of(fit_resins(table, {}), "W").sigma_t[1].standard_error ==
          Approx(2 * resin_of(even, "W").sigma_t[1].standard_error).epsilon(0.01));
    // A patch that is wrong does no harm where it says so itself.
    for (Patch& patch : table.patches) patch.error.assign(3, 0.005);
    for (Patch& patch : table.patches)
        if (is(patch, "Y", "W")) patch.rho[0] = 0.4, patch.error[0] = 1;
    const ResinFit fit = fit_resins(table, {});
    CHECK(fit.misfit.empty());
    CHECK(resin_of(fit, "Y").sigma_t[0].value == Approx(2.25).epsilon(0.15));
}

TEST_CASE("A calibration that is not possible says what is missing") {
    PatchTable table = measured('B', 0);
    table.source = "p.csv";
    PatchTable broken = table;
    erase(broken, [](const Patch& p) { return is(p, "W", "W"); });
    CHECK_THAT(fault(broken), Contains("p.csv") && Contains("W on W is missing"));
    broken = table;
    erase(broken, [](const Patch& p) { return p.backing == "W" && contains(p, "K"); });
    CHECK_THAT(fault(broken), Contains("K on W is missing"));
    broken = table;
    erase(broken, [](const Patch& p) { return p.backing == "K"; });
    CHECK_THAT(fault(broken), Contains("all patches lie on W"));
    broken = table;
    erase(broken, [](const Patch& p) { return !is(p, "W", "W"); });
    CHECK_THAT(fault(broken), Contains("one resin, W"));
    broken = table;  // the names of the bases changed places
    for (Patch& patch : broken.patches) {
        patch.backing = patch.backing == "W" ? "K" : patch.backing == "K" ? "W" : patch.backing;
        for (ResinShare& share : patch.top) share.role = share.role == "W" ? "K" : share.role == "K" ? "W" : share.role;
    }
    CHECK_THAT(fault(broken), Contains("swapped"));
    broken = table;
    for (Patch& patch : broken.patches)
        if (is(patch, "K", "K")) patch.rho = {0.79, 0.88, 0.79};
    CHECK_THAT(fault(broken), Contains("no contrast"));
    FitOptions six;
    six.expected = {"C", "M", "Y", "K", "W", "O"};
    CHECK_THAT(fault(table, six), Contains("resin O has no patch"));
    FitOptions wrong;
    wrong.model.g = 1;
    CHECK_THAT(fault(table, wrong), Contains("g is 1"));
    wrong = {};
    wrong.noise = 0;
    CHECK_THAT(fault(table, wrong), Contains("noise is 0"));
    wrong = {};
    wrong.model.pitch_mm = {0.04, 0, 0.03};
    CHECK_THAT(fault(table, wrong), Contains("pitch is 0"));
}

TEST_CASE("A colour seen on one base only is fitted as far as it can be, and doubted") {
    PatchTable table = measured('A', 0.005);
    erase(table, [](const Patch& p) { return contains(p, "M") && p.backing == "K"; });
    const ResinFit fit = fit_resins(table, {});
    const FittedResin& magenta = resin_of(fit, "M");
    for (std::size_t c = 0; c < 3; ++c)
        CHECK((!magenta.albedo[c].doubts.empty() || !magenta.sigma_t[c].doubts.empty()));
    CHECK(resin_of(fit, "Y").sigma_t[0].doubts.empty());
}

TEST_CASE("Bases that are crossed by mixtures with colours only are found too") {
    PatchTable table = measured('C', 0);
    erase(table, [](const Patch& p) {
        return !contains(p, "C") && !contains(p, "M") && !contains(p, "Y") && !is(p, "W", "W") && !is(p, "K", "K");
    });
    table.patches.push_back({{{"C", 0.5}, {"K", 0.5}}, "W", 0.675, 0, {}, {}, {}});
    table.patches.push_back({{{"Y", 0.5}, {"K", 0.5}}, "W", 0.675, 0, {}, {}, {}});
    table.patches.push_back({{{"M", 0.5}, {"K", 0.5}}, "W", 0.675, 0, {}, {}, {}});
    measure(table, optics::vero_opaque(), 0, 1);
    const ResinFit fit = fit_resins(table, {});
    CHECK(fit.patches.rms < 1e-4);
    CHECK(resin_of(fit, "W").sigma_t[1].value == Approx(9).epsilon(0.01));
}

TEST_CASE("Nonsense in, doubts or a refusal out, and never a broken number", "[slow]") {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        PatchTable table = measured(seed % 2 ? 'A' : 'B', 0);
        std::size_t at = 0;
        for (Patch& patch : table.patches) {
            for (double& rho : patch.rho) rho = RandomStream(seed, at++, 3).uniform();
            if (seed % 3 == 0) patch.error.assign(3, seed % 2 ? 1e-12 : 1);
            if (seed % 4 == 0) patch.thickness_mm = seed % 8 ? 0.001 : 1000;
        }
        try {
            const ResinFit fit = fit_resins(table, {});
            fit.set.validate();
            CHECK(std::isfinite(fit.patches.rms));
            for (const FittedResin& resin : fit.resins)
                for (std::size_t c = 0; c < 3; ++c)
                    for (const FittedValue* value : {&resin.albedo[c], &resin.sigma_t[c]}) {
                        CHECK(std::isfinite(value->standard_error));
                        CHECK(value->low <= value->value + 1e-9);
                        CHECK(value->value <= value->high + 1e-9);
                    }
            if (seed % 3 != 0) CHECK(fit.misfit.size() == 3);
        } catch (const InputError& error) {
            CHECK_THAT(error.what(), Contains("swapped") || Contains("contrast"));
        }
    }
}

TEST_CASE("A check refuses patches of resins that the set has not") {
    const PatchTable table = measured('B', 0);
    CHECK(check_resins(optics::vero_opaque(), table, {}).differences.max < 1e-6);
    optics::ResinSet four = optics::vero_opaque();
    four.resins.erase(four.resins.begin());
    CHECK_THROWS_WITH(check_resins(four, table, {}), Contains("C on W") && Contains("no resin C"));
}

TEST_CASE("Any set is checked by any table, each through its own observer") {
    const PatchTable rgb = measured('B', 0.005);
    const optics::ResinSet own = optics::testing::split_set(optics::vero_opaque(), optics::testing::green_twice);
    const PatchCheck plain = check_resins(optics::vero_opaque(), rgb, {}), check = check_resins(own, rgb, {});
    CHECK(plain.compared_in == rgb.channels);
    CHECK(check.compared_in.is_rgb());
    CHECK(check.differences.mean == Approx(plain.differences.mean).margin(1e-6));
    CHECK(check.rms == Approx(plain.rms).margin(1e-9));
    for (std::size_t p = 0; p < rgb.patches.size(); ++p) {
        CHECK(check.patches[p].predicted.size() == 4);
        CHECK(check.patches[p].worst == Approx(plain.patches[p].worst).margin(1e-9));
    }
    // A table of X, Y, Z of the same colours.
    PatchTable xyz = rgb;
    xyz.channels = optics::colorimetric_channels(optics::Illuminant::d65);
    const Eigen::Matrix3d to_xyz = Eigen::Matrix3d(optics::linear_srgb_weights(xyz.channels)).inverse();
    for (Patch& patch : xyz.patches) {
        Eigen::Map<Eigen::Vector3d> rho(patch.rho.data());
        rho = (to_xyz * rho).eval();
        patch.error.clear();
    }
    for (const optics::ResinSet& set : {optics::vero_opaque(), own})
        CHECK(check_resins(set, xyz, {}).differences.mean == Approx(plain.differences.mean).margin(1e-6));
    // Set and table in the same own channels are compared by these.
    PatchTable of_own = target('B', {"C", "M", "Y"});
    measure(of_own, own, 0.0, 1);
    const PatchCheck exact = check_resins(own, of_own, {});
    CHECK(exact.compared_in == own.channels);
    CHECK(exact.rms < 1e-9);
    CHECK(check_resins(optics::vero_opaque(), of_own, {}).differences.max < 1e-4);

    const std::string page = check_report_html(xyz, check_resins(own, xyz, {}), own, chart_of_patches(xyz));
    CHECK_THAT(page,
               Contains("C on W") && Contains("Measured R, G, B") && !Contains("standard errors") && !Contains("nan "));
    const std::string by_channel = check_report_html(of_own, exact, own, chart_of_patches(of_own));
    CHECK_THAT(by_channel, Contains("in channel ") && !Contains("nan "));
}

TEST_CASE("A fit in channels of a printer's own is drawn by channel") {
    const optics::ResinSet truth = optics::testing::split_set(optics::vero_opaque(), optics::testing::green_twice);
    PatchTable table = target('A', {"C", "M", "Y"});
    measure(table, truth, 0.005, 1);
    const ResinFit fit = fit_resins(table, {});
    CHECK(fit.set.channels == truth.channels);
    const std::string page = fit_report_html(fit, table, {}, chart_of_patches(table));
    CHECK_THAT(page, Contains("channel 4") && !Contains("nan ") && !Contains("inf "));
}

TEST_CASE("The report shows every patch, holds no broken number, and lets no name become markup", "[slow]") {
    optics::ResinSet truth = optics::vero_opaque();
    truth.resins[0].role = "<b>&";
    for (const bool spectral : {false, true}) {
        if (spectral) truth.channels.wavelengths_nm = {450, 550, 610};
        PatchTable table = target('A', {"<b>&", "M", "Y"});
        measure(table, truth, 0.005, 1);
        const ResinFit fit = fit_resins(table, {});
        const std::string page = fit_report_html(fit, table, {}, chart_of_patches(table));
        CHECK_THAT(page, Contains("&lt;b&gt;&amp; on W") && Contains("Principle 3") && Contains("</html>"));
        CHECK_THAT(page, !Contains("<b>&") && !Contains("nan ") && !Contains("inf ") && !Contains("http://") &&
                             !Contains("https://"));
        // Each in the list of parts for the probe, and in the table.
        for (const Patch& patch : table.patches) {
            const std::string name = patch_name(patch);
            CHECK_THAT(page, Contains("<td>" + io::html_text(name) + "</td>"));
            if (name.find('<') == std::string::npos) CHECK_THAT(page, Contains("{\"name\": \"" + name + "\""));
        }
    }
}
