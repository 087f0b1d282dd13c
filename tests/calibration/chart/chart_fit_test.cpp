// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_fit.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/chart/chart_lengths.h"
#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_bands.h"
#include "calibration/chart/observer_model.h"
#include "calibration/chart/observer_start.h"
#include "calibration/chart/residual_fit.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_model.h"
#include "io/profiles/resin_file.h"
#include "tests/calibration/chart/chart_samples.h"
#include "tests/same_for_threads.h"

namespace voxtone::calibration {
namespace {

using Catch::Contains;

ChartFitOptions options_for(int channels) {
    ChartFitOptions options;
    options.name = "fitted";
    options.channels = channels;
    options.lengths_from = optics::vero_opaque();
    return options;
}

}  // namespace

TEST_CASE("The observer model's derivatives are those of its values") {
    const auto [pitch, lengths, known_observer] = GENERATE(table<double, bool, bool>(
        {{0, false, false}, {0.03, false, false}, {0, true, false}, {0.05, true, false}, {0.05, true, true}}));
    CAPTURE(pitch, lengths, known_observer);
    const ObserverModel model(
        3, 1, 4, {.pitch_mm = {pitch, 2 * pitch, pitch / 2}, .lengths = lengths, .known_observer = known_observer});
    Eigen::VectorXd unknowns(model.unknowns());
    RandomStream random(3, 0);
    for (Eigen::Index i = 0; i < unknowns.size(); ++i) unknowns[i] = 2 * random.uniform() - 1.5;
    const Eigen::RowVector3d shares(0.2, 0.3, 0.5);
    ObserverParts known;
    known.scattering = Eigen::Vector4d(20, 15, 12, 9);
    known.weights = start_weights(4);
    Eigen::Matrix3Xd by(3, model.unknowns()), unused(3, model.unknowns());
    const auto colour = [&](const Eigen::VectorXd& at, Eigen::Matrix3Xd& slopes) {
        const ObserverParts parts = model.parts(at, known);
        return model.colour(parts, model.law(parts), shares, slopes);
    };
    const Eigen::Vector3d value = colour(unknowns, by);
    const ObserverParts parts = model.parts(unknowns, known);
    CHECK((model.colours(parts, shares).row(0).transpose() - value).norm() < 1e-14);
    CHECK((model.unknowns_of(parts).head(model.observer_at()) - unknowns.head(model.observer_at())).norm() < 1e-12);
    for (Eigen::Index i = 0; i < unknowns.size(); ++i) {
        const double step = 1e-6;
        Eigen::VectorXd up = unknowns, down = unknowns;
        up[i] += step, down[i] -= step;
        const Eigen::Vector3d slope = (colour(up, unused) - colour(down, unused)) / (2 * step);
        CAPTURE(i);
        CHECK((by.col(i) - slope).norm() < 1e-6 * (1 + slope.norm()));
        // Lengths tell on thick pieces by their voxels alone.
        const bool of_length = lengths && i >= model.length_at(0) && i < model.spread_at();
        CHECK((slope.norm() > 1e-7) == !(of_length && pitch == 0));
    }
}

TEST_CASE("A chart drawn by a set of four channels is fitted and foretells mixtures that it has not seen") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    const PatchTable chart = testing::drawn_chart(truth, 120, 1, 0.03), others = testing::drawn_chart(truth, 300, 2, 0);
    const ChartFit fit = fit_chart(chart, options_for(4));
    CHECK(fit.set.channels.size() == 4);
    CHECK_NOTHROW(fit.set.validate());
    const auto unseen = check_resins(fit.set, others, {}).differences;
    CHECK(unseen.mean < 0.5);
    CHECK(unseen.percentile_95 < 1.5);
    // What cross-validation promises is what others find, but for the noise of what it was judged by.
    CHECK(fit.held_out.mean < 1.5 * unseen.mean + 0.3);
    CHECK(fit.held_out.mean > 0.6 * unseen.mean);
    CHECK(fit.residual_anew);
    CHECK(fit.solids.size() == 5);
    // Three channels of sRGB, as a set without an observer has them, cannot say as much.
    const auto vero = check_resins(optics::vero_opaque(), others, {}).differences;
    CHECK(vero.mean > 4 * unseen.mean);
}

TEST_CASE("A residual follows what was left by as much as repeats say that it is no noise") {
    // Two mixtures too far apart to share anything: each weight is left / (1 + noise / repeats), and so is what is told
    // there.
    ChartData data;
    data.shares = Eigen::MatrixXd::Identity(2, 2);
    data.repeats = Eigen::Vector2d(1, 4);
    Eigen::MatrixX3d left(2, 3);
    left << 0.1, -0.2, 0.3, 0.4, 0.1, -0.1;
    const ResidualShape shape{{1e-3, 1e-3}, 0.5};
    const optics::ColourResidual residual = make_residual(data, left, shape);
    for (Eigen::Index i = 0; i < 2; ++i) {
        const Eigen::RowVector2d shares = data.shares.row(i);
        const Eigen::Vector3d told = residual({shares.data(), 2}),
                              wanted = left.row(i).transpose() / (1 + 0.5 / data.repeats[i]);
        CHECK((told - wanted).norm() < 1e-9);
    }
}

TEST_CASE("A fit of a chart is the same for any number of threads, and survives its file") {
    const PatchTable chart = testing::drawn_chart(testing::wide_gamut_set(), 60, 3, 0.2);
    const std::string one =
        test::same_for_threads([&] { return io::resin_set_text(fit_chart(chart, options_for(3)).set); }, {2});
    const optics::ResinSet back = io::parse_resin_set(one, "fit");
    CHECK(io::resin_set_text(back) == one);
    CHECK(back.dot_spread == 1);
    CHECK(back.residual.centres().rows() > 40);
    CHECK(back.residual == io::parse_resin_set(io::resin_set_text(back), "again").residual);
}

TEST_CASE("A law of shares that the model does not have is taken by the residual", "[slow]") {
    // White of a share f works like f^0.8: smooth, and no resin's constant.
    const optics::ResinSet truth = testing::wide_gamut_set();
    const auto bend = [](PatchTable table, const optics::ResinSet& set) {
        const optics::FlatColour flat(set);
        for (Patch& patch : table.patches) {
            std::vector<double> shares(5);
            double sum = 0;
            for (const ResinShare& share : patch.top) {
                const auto r = static_cast<std::size_t>(set.find(share.role));
                shares[r] = share.role == "W" ? std::pow(share.fraction, 0.8) : share.fraction;
                sum += shares[r];
            }
            for (double& share : shares) share /= sum;
            const Eigen::Vector3d xyz = flat.xyz(shares).cwiseQuotient(flat.white());
            patch.rho = {xyz[0], xyz[1], xyz[2]};
        }
        return table;
    };
    const PatchTable chart = bend(testing::drawn_chart(truth, 200, 5, 0), truth),
                     others = bend(testing::drawn_chart(truth, 200, 6, 0), truth);
    const ChartFit fit = fit_chart(chart, options_for(3));
    optics::ResinSet physics = fit.set;
    physics.residual = {};
    const double with = check_resins(fit.set, others, {}).differences.mean,
                 without = check_resins(physics, others, {}).differences.mean;
    CHECK(with < 0.7 * without);
    CHECK(fit.residual_size > 0.1);
    ChartFitOptions plain = options_for(3);
    plain.residual = false;
    CHECK(fit_chart(chart, plain).set.residual.empty());
}

TEST_CASE("Lengths come from the white of another set, channel by channel") {
    const optics::ResinSet vero = optics::vero_opaque();
    const std::vector<double> same = white_scattering(vero.channels, 0.4, vero);
    for (std::size_t c = 0; c < 3; ++c) CHECK(same[c] == Approx(vero.resins[4].medium(c).sigma_s).epsilon(1e-12));
    // By similarity: light that scatters forward less wants less scattering.
    CHECK(white_scattering(vero.channels, 0.0, vero)[1] == Approx(0.6 * same[1]).epsilon(1e-12));
    const std::vector<std::string> inks{"C", "M"};
    CHECK_THROWS_WITH(white_scattering(vero.channels, 0.4, vero.subset(inks)), Contains("no white resin W"));
}

namespace {

// Squares of the resins and of halves with white, 0.1 to 0.4 mm thick, upon white and black.
PatchTable drawn_squares(const optics::ResinSet& set, PatchModelOptions options, bool as_chart) {
    PatchTable table;
    table.source = "squares";
    table.channels = set.channels;
    for (const char* role : {"C", "M", "Y", "K", "W"})
        for (const double share : {1.0, 0.5})
            for (const double thickness : {0.1, 0.2, 0.4})
                for (const char* backing : {"W", "K"}) {
                    Patch patch;
                    patch.top = {{role, share}};
                    if (share < 1 && std::string(role) == "W") continue;
                    if (share < 1) patch.top.push_back({"W", 1 - share});
                    patch.thickness_mm = thickness, patch.backing = backing;
                    table.patches.push_back(patch);
                }
    std::vector<std::string> roles;
    for (const optics::Resin& resin : set.resins) roles.push_back(resin.role);
    options.dot_spread = set.dot_spread;
    const PatchModel model(table.patches, roles, options);
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        std::vector<optics::Medium> media;
        for (const optics::Resin& resin : set.resins) media.push_back(resin.medium(c));
        const std::vector<double> rho = model.rho(media);
        for (std::size_t p = 0; p < rho.size(); ++p)
            table.patches[p].rho.push_back(as_chart ? set.measured.gain * (set.measured.surface + rho[p]) : rho[p]);
    }
    if (!as_chart) return table;
    // As the chart's own table tells them: X/Xn, Y/Yn, Z/Zn.
    const Eigen::Vector3d white = optics::colorimetric_white(set.channels.illuminant);
    for (Patch& patch : table.patches) {
        Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
        for (std::size_t c = 0; c < patch.rho.size(); ++c)
            xyz += patch.rho[c] * Eigen::Map<const Eigen::Vector3d>(set.channels.xyz[c].data());
        xyz = xyz.cwiseQuotient(white);
        patch.rho = {xyz[0], xyz[1], xyz[2]};
    }
    return table;
}

double worst_length(const optics::ResinSet& fitted, const optics::ResinSet& truth) {
    double worst = 0;
    for (std::size_t c = 0; c < truth.channels.size(); ++c) {
        const auto of = [&](const optics::ResinSet& set) {
            return set.resins[static_cast<std::size_t>(set.find("W"))].medium(c).sigma_s;
        };
        worst = std::max(worst, std::abs(std::log(of(fitted) / of(truth))));
    }
    return worst;
}

}  // namespace

TEST_CASE("Thin squares tell a chart's lengths, in its own table or in another one", "[slow]") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    const PatchTable chart = testing::drawn_chart(truth, 120, 1, 0.03);
    const ChartFit without = fit_chart(chart, options_for(4));
    CHECK(worst_length(without.set, truth) > 0.25);
    CHECK(without.squares_held_out.count == 0);

    ChartFitOptions options = options_for(4);
    options.squares = drawn_squares(truth, {}, false);
    const ChartFit other = fit_chart(chart, options);
    PatchTable own = chart;
    const PatchTable squares = drawn_squares(truth, {}, true);
    own.patches.insert(own.patches.end(), squares.patches.begin(), squares.patches.end());
    const ChartFit same = fit_chart(own, options_for(4));
    for (const ChartFit* fit : {&other, &same}) {
        CHECK(worst_length(fit->set, truth) < 0.1);
        CHECK(fit->squares_held_out.count == squares.patches.size());
        CHECK(fit->squares_held_out.mean < 0.6);
        CHECK(fit->length_error.size() == 4);
        CHECK(fit->held_out.mean < 1.2 * without.held_out.mean + 0.1);
    }
    // And a check of both kinds of rows in one table.
    CHECK(check_resins(same.set, own, {}).differences.mean < 0.6);
    CHECK(check_resins(without.set, own, {}).differences.mean > check_resins(same.set, own, {}).differences.mean + 0.2);
}

TEST_CASE("Spectra give an observer of few bands outright, which is taken where it foretells better", "[slow]") {
    const PatchTable others = testing::drawn_spectra(300, 2, 0);
    const auto fitted = [](std::size_t patches) {
        return fit_chart(testing::drawn_spectra(patches, 1, 0.001), options_for(6));
    };
    // Thirty spectra choose no bands that serve others; a hundred and twenty do.
    const ChartFit few = fitted(30), many = fitted(120);
    for (const ChartFit* fit : {&few, &many}) {
        REQUIRE(fit->curve.size() == 2);
        CHECK(!fit->curve[0].observer.of_spectra);
        CHECK(fit->curve[1].observer.of_spectra);
    }
    CHECK(!few.observer.of_spectra);
    CHECK(many.observer.of_spectra);
    CHECK(many.curve[1].physics < 0.9 * many.curve[0].physics);
    CHECK(check_resins(many.set, others, {}).differences.mean < 0.3);
    CHECK_NOTHROW(many.set.validate());
}

TEST_CASE("Bands of spectra give their colours by weights that are no less than zero") {
    const ChartData data = chart_data(testing::drawn_spectra(200, 1, 0)),
                    others = chart_data(testing::drawn_spectra(200, 2, 0));
    double before = 10;
    for (const Eigen::Index count : {3, 4, 6, 9}) {
        const ObserverBands bands = observer_bands(data.spectra, data.observer, count);
        CHECK(bands.weights.minCoeff() >= 0);
        CHECK((bands.weights.colwise().sum().array() - 1).abs().maxCoeff() < 1e-12);
        CHECK(std::ranges::is_sorted(bands.nodes));
        Eigen::MatrixX3d seen = others.spectra(Eigen::all, bands.nodes) * bands.weights;
        Eigen::MatrixX3d even = Eigen::MatrixX3d::Zero(others.mixtures(), 3);
        // As many even bands, each the light around it.
        for (Eigen::Index w = 0; w < data.observer.rows(); ++w) {
            const Eigen::Index band = w * count / data.observer.rows();
            even += others.spectra.col((2 * band + 1) * data.observer.rows() / (2 * count)) * data.observer.row(w);
        }
        const auto differ = [&](Eigen::MatrixX3d& colours) {
            for (Eigen::Index i = 0; i < colours.rows(); ++i)
                colours.row(i) = roots_of(colours.row(i).transpose()).transpose();
            return optics::summarize(root_differences(colours, others.roots)).mean;
        };
        const double now = differ(seen);
        CAPTURE(count, now);
        CHECK(now < 0.7 * before);
        CHECK(now < 0.75 * differ(even));
        before = now;
    }
    CHECK(before < 0.2);
}

TEST_CASE("How far droplets run together is found from a chart, with its error", "[slow]") {
    optics::ResinSet truth = testing::wide_gamut_set();
    truth.dot_spread = GENERATE(0.1, 0.6);
    const std::array<double, 3> pitch{25.4 / 600, 25.4 / 300, 0.027};
    PatchTable chart = testing::drawn_chart(truth, 200, 1, 0);
    const optics::FlatColour flat(truth, pitch);
    for (Patch& patch : chart.patches) {
        std::vector<double> shares(5);
        for (const ResinShare& share : patch.top)
            shares[static_cast<std::size_t>(truth.find(share.role))] = share.fraction;
        const Eigen::Vector3d xyz = flat.xyz(shares).cwiseQuotient(flat.white());
        patch.rho = {xyz[0], xyz[1], xyz[2]};
    }
    ChartFitOptions options = options_for(4);
    options.pitch_mm = pitch;
    PatchModelOptions voxels;
    voxels.pitch_mm = pitch;
    options.squares = drawn_squares(truth, voxels, false);
    const ChartFit fit = fit_chart(chart, options);
    CAPTURE(fit.set.dot_spread, fit.dot_spread_error);
    CHECK(fit.set.dot_spread == Approx(truth.dot_spread).margin(3 * fit.dot_spread_error));
    CHECK(fit.dot_spread_error > 0);
    CHECK(fit.dot_spread_error < 0.03);
}

TEST_CASE("Charts that cannot be fitted are refused in a sentence") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    const auto refused = [](const PatchTable& table, const ChartFitOptions& options) -> std::string {
        try {
            (void)fit_chart(table, options);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK_THAT(refused(testing::drawn_chart(truth, 5, 1, 0), options_for(3)),
               Contains("5 different mixtures are too few"));
    CHECK_THAT(refused(testing::drawn_chart(truth, 8, 1, 0), options_for(9)),
               Contains("too few") && Contains("9 channels"));
    CHECK_THAT(refused(testing::drawn_chart(truth, 40, 1, 0), options_for(13)), Contains("13 channels"));
    PatchTable grey = testing::drawn_chart(truth, 40, 1, 0);
    for (Patch& patch : grey.patches) patch.rho.assign(3, patch.rho[1]);
    CHECK_THAT(refused(grey, options_for(3)), Contains("one hue"));
    ChartFitOptions wanted = options_for(3);
    wanted.expected = {"T"};
    CHECK_THAT(refused(testing::drawn_chart(truth, 40, 1, 0), wanted), Contains("no patch holds the resin T"));
    PatchTable clear = testing::drawn_chart(truth, 40, 1, 0);
    clear.patches.push_back(clear.patches[3]);
    clear.patches.back().thickness_mm = 0.5, clear.patches.back().backing = "T";
    CHECK_THAT(refused(clear, options_for(3)), Contains("upon T holds the resin T, which no thick mixture"));
    PatchTable thin = testing::drawn_chart(truth, 40, 1, 0);
    for (Patch& patch : thin.patches) patch.thickness_mm = 0.5, patch.backing = "W";
    CHECK_THAT(refused(thin, options_for(3)), Contains("all patches are thin squares"));
    ChartFitOptions with_thick = options_for(3);
    with_thick.squares = testing::drawn_chart(truth, 6, 1, 0);
    CHECK_THAT(refused(testing::drawn_chart(truth, 40, 1, 0), with_thick), Contains("is thick; squares"));
}

}  // namespace voxtone::calibration
