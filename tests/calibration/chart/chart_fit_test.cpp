// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/chart/chart_fit.h"

#include <catch2/catch.hpp>

#include "tests/calibration/chart/chart_samples.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/calibration/chart/chart_lengths.h"
#include "voxtone/calibration/chart/observer_model.h"
#include "voxtone/calibration/patches/patch_check.h"
#include "voxtone/io/profiles/resin_file.h"

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
    const ObserverModel model(3, 2, 4, 0.4, 1.5, optics::MeasuringGeometry::directional_45_0);
    Eigen::VectorXd unknowns(model.unknowns());
    RandomStream random(3, 0);
    for (Eigen::Index i = 0; i < unknowns.size(); ++i) unknowns[i] = 2 * random.uniform() - 1.5;
    const Eigen::RowVector3d shares(0.2, 0.3, 0.5);
    Eigen::Matrix3Xd by(3, model.unknowns()), unused(3, model.unknowns());
    const Eigen::Vector3d colour = model.colour(model.parts(unknowns), shares, by);
    CHECK((model.colours(model.parts(unknowns), shares).row(0).transpose() - colour).norm() < 1e-14);
    CHECK((model.unknowns_of(model.parts(unknowns)).head(4) - unknowns.head(4)).norm() < 1e-12);
    for (Eigen::Index i = 0; i < unknowns.size(); ++i) {
        const double step = 1e-6;
        Eigen::VectorXd up = unknowns, down = unknowns;
        up[i] += step, down[i] -= step;
        const Eigen::Vector3d slope =
            (model.colour(model.parts(up), shares, unused) - model.colour(model.parts(down), shares, unused)) /
            (2 * step);
        CAPTURE(i);
        CHECK((by.col(i) - slope).norm() < 1e-6 * (1 + slope.norm()));
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
    CHECK(fit.solids.size() == 5);
    // Three channels of sRGB, as a set without an observer has them, cannot say as much.
    const auto vero = check_resins(optics::vero_opaque(), others, {}).differences;
    CHECK(vero.mean > 4 * unseen.mean);
}

TEST_CASE("A fit of a chart is the same for any number of threads, and survives its file") {
    const PatchTable chart = testing::drawn_chart(testing::wide_gamut_set(), 60, 3, 0.2);
    const auto text = [&](std::size_t threads) {
        const ThreadLimit limit(threads);
        return io::resin_set_text(fit_chart(chart, options_for(3)).set);
    };
    const std::string one = text(1);
    CHECK(one == text(2));
    const optics::ResinSet back = io::parse_resin_set(one, "fit");
    CHECK(io::resin_set_text(back) == one);
    CHECK(back.dot_spread == 1);
    CHECK(back.residual.centres().rows() > 40);
    CHECK(back.residual == io::parse_resin_set(io::resin_set_text(back), "again").residual);
}

TEST_CASE("A law of shares that the model does not have is taken by the residual") {
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
    PatchTable thin = testing::drawn_chart(truth, 40, 1, 0);
    thin.patches[3].thickness_mm = 0.5, thin.patches[3].backing = "W";
    CHECK_THAT(refused(thin, options_for(3)), Contains("0.5 mm thick upon W"));
}

}  // namespace voxtone::calibration
