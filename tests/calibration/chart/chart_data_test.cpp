// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_data.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/chart/chart_folds.h"
#include "calibration/chart/chart_text.h"
#include "tests/calibration/patches/chart_samples.h"

namespace voxtone::calibration {
namespace {

using Catch::Contains;
using test::parsed;

const std::string chart_rows_text = "W,C,K,L,a,b\n1,0,0,92,-1,3\n0,1,0,50,-30,-40\n0,0,1,8,0,0\n0.5,0.5,0,70,-20,-15\n";

std::string squares_text(const std::string& lab) { return "top,backing,thickness_mm,L,a,b\nW,K,0.5," + lab + "\n"; }

Eigen::Vector3d lab_of_square(const ChartData& data, Eigen::Index row) {
    return lab_of_roots() * data.squares.roots.row(row).transpose() - Eigen::Vector3d(16, 0, 0);
}

}  // namespace

TEST_CASE("Squares that were measured under another light than the chart are seen under the chart's") {
    using optics::Illuminant;
    for (const Illuminant chart_light : {Illuminant::d50, Illuminant::d65})
        for (const Illuminant square_light : {Illuminant::d50, Illuminant::d65, Illuminant::a}) {
            const PatchTable chart = parsed(chart_rows_text, chart_light);
            // Grey is grey under every light.
            const ChartData grey = chart_data(chart, parsed(squares_text("60,0,0"), square_light));
            REQUIRE(grey.squares.roots.rows() == 1);
            CHECK((lab_of_square(grey, 0) - Eigen::Vector3d(60, 0, 0)).norm() < 1e-9);
            // A colour is what adaptation makes of it: a red of incandescent light is none of daylight's Lab.
            const Eigen::Vector3d red(50, 40, 20);
            const ChartData seen = chart_data(chart, parsed(squares_text("50,40,20"), square_light));
            const Eigen::Vector3d from = optics::colorimetric_white(square_light),
                                  to = optics::colorimetric_white(chart_light);
            const Eigen::Vector3d wanted =
                optics::lab_from_xyz(optics::adapt_white(optics::xyz_from_lab(red, from), from, to), to);
            CHECK((lab_of_square(seen, 0) - wanted).norm() < 1e-9);
            CHECK(((wanted - red).norm() < 1e-9) == (square_light == chart_light));
            CHECK(seen.illuminant == chart_light);
        }
}

TEST_CASE("Thin patches of a chart are squares of its instrument, those of another table are not") {
    const PatchTable chart = parsed(
        "W,C,K,thickness_mm,backing,L,a,b\n1,0,0,,,92,-1,3\n0,1,0,,,50,-30,-40\n0,0,1,,,8,0,0\n1,0,0,0.5,K,60,0,0\n");
    const ChartData data = chart_data(chart, parsed(squares_text("61,0,0")));
    CHECK(data.mixtures() == 3);
    CHECK(data.squares.own_instrument == std::vector<bool>{false, true});
    CHECK(lab_of_square(data, 0)[0] == Approx(60));
    CHECK(lab_of_square(data, 1)[0] == Approx(61));
    CHECK(data.tells_lengths());
    CHECK_FALSE(chart_data(parsed(chart_rows_text)).tells_lengths());
    CHECK_THROWS_WITH(chart_data(parsed("W,C,L,a,b\n1,0,92,-1,3\n0,1,50,-30,-40\n"), parsed(squares_text("61,0,0"))),
                      Contains("holds the resin K"));
}

TEST_CASE("Repeats of a mixture are its mean, and how far they lie from it is the noise") {
    const ChartData once = chart_data(parsed(chart_rows_text));
    CHECK(once.noise.count == 0);
    CHECK(once.roles == std::vector<std::string>{"C", "K", "W"});
    CHECK(once.repeats == Eigen::VectorXd::Ones(4));
    for (Eigen::Index row = 0; row < once.mixtures(); ++row) CHECK(once.shares.row(row).sum() == Approx(1));
    const ChartData twice = chart_data(parsed(chart_rows_text + "1,0,0,93,-1,3\n"));
    CHECK(twice.mixtures() == 4);
    CHECK(twice.repeats == Eigen::Vector4d(2, 1, 1, 1));
    CHECK(twice.noise.count == 2);
    // Lightness alone differs: 116 (f(Y/Yn) - 16 / 116), whose mean is between the two.
    CHECK(twice.lab(0, 0) == Approx(92.5));
    CHECK(twice.lab(1, 0) == Approx(50));
}

TEST_CASE("A choice is judged by folds that had no part in it") {
    // Without the first fold the second choice looks better, without the second the first: 2 + 3, where both folds
    // together choose the second and find 2 + 1.
    CHECK(judged_anew({{1, 3}, {2, 1}}) == 5);
    CHECK(judged_anew({{1, 1, 1}, {2, 2, 2}}) == 3);
    // The first within a hundredth of the best is taken.
    CHECK(judged_anew({{1.005, 1.005}, {1, 1}}) == Approx(2.01));
    CHECK(judged_anew({{1.02, 1.02}, {1, 1}}) == 2);
}

TEST_CASE("A fit says which of its held-out figures were chosen on what they judge") {
    ChartFit fit;
    CHECK(honesty_of(fit).empty());
    fit.curve = {{{3, false}, 2, 1.5}, {{4, false}, 2, 1.2}};
    fit.observer = {4, false};
    fit.chosen_anew = 1.3;
    CHECK_THAT(honesty_of(fit), Contains("1.20 of the curve is 1.30") && !Contains("residual"));
    fit.residual_anew = true;
    CHECK_THAT(honesty_of(fit), Contains("chosen anew without the mixtures"));
    CHECK_THAT(chart_fit_text(fit), Contains(honesty_of(fit)));
}

}  // namespace voxtone::calibration
