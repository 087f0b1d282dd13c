// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/layer_fit.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <numeric>

#include "base/error.h"
#include "calibration/layers/layer_model.h"
#include "optics/colour/observed_colour.h"
#include "tests/calibration/chart/chart_samples.h"
#include "tests/places.h"

namespace voxtone::calibration {
namespace {

using Catch::Contains;

/// Laminates of four layers of 0.05 to 0.1 mm on 2 mm of white, as a colorimeter reads them.
LayerChart drawn_laminates(const optics::ResinSet& set, std::size_t count, std::uint64_t seed) {
    LayerChart chart;
    chart.source = "drawn";
    for (const optics::Resin& resin : set.resins) chart.roles.push_back(resin.role);
    for (std::uint64_t i = 0; i < count; ++i) {
        RandomStream random(seed, i);
        LayerLaminate laminate;
        for (int k = 0; k < 4; ++k)
            laminate.push_back({static_cast<std::size_t>(random.uniform() * 5), random.uniform() < 0.5 ? 0.05 : 0.1});
        laminate.push_back({4, 2});
        chart.laminates.push_back(std::move(laminate));
    }
    const LaminateReflectance laminates(chart.laminates, set.g, set.eta, 6);
    std::vector<std::vector<double>> rho;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        std::vector<optics::Medium> media;
        for (const optics::Resin& resin : set.resins) media.push_back(resin.medium(c));
        rho.push_back(laminates.rho(laminates.laws(std::move(media))));
    }
    const Eigen::Vector3d white = optics::d50_white();
    chart.lab.resize(static_cast<Eigen::Index>(count), 3);
    for (std::size_t i = 0; i < count; ++i) {
        Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
        for (std::size_t c = 0; c < rho.size(); ++c)
            xyz += set.measured.gain * (set.measured.surface + rho[c][i]) *
                   Eigen::Map<const Eigen::Vector3d>(set.channels.xyz[c].data());
        chart.lab.row(static_cast<Eigen::Index>(i)) = optics::lab_from_xyz(xyz, white).transpose();
    }
    return chart;
}

LayerChart upside_down(LayerChart chart) {
    for (LayerLaminate& laminate : chart.laminates) std::reverse(laminate.begin(), laminate.end() - 1);
    return chart;
}

LayerChart measured_laminates() {
    return *read_layer_chart(std::filesystem::path(test::source_dir()) / "tests/data/layers/cmyb-5-layers.json",
                             optics::Illuminant::d50);
}

/// Every `step`th laminate from `first` on.
LayerChart some(const LayerChart& chart, std::size_t first, std::size_t step) {
    std::vector<std::size_t> keep;
    for (std::size_t i = first; i < chart.laminates.size(); i += step) keep.push_back(i);
    return chart_laminates(chart, keep);
}

}  // namespace

TEST_CASE("Laminates that share layers are what each of them is alone, and eight directions are enough") {
    const optics::ResinSet set = testing::wide_gamut_set();
    const LayerChart chart = drawn_laminates(set, 40, 5);
    const LaminateReflectance coarse(chart.laminates, 0.4, 1.5), fine(chart.laminates, 0.4, 1.5, 7);
    std::vector<optics::Medium> media;
    for (const optics::Resin& resin : set.resins) media.push_back(resin.medium(1));
    const auto laws = coarse.laws(media);
    const std::vector<double> seen = coarse.rho(laws), exact = fine.rho(fine.laws(media));
    std::vector<optics::Medium> other = media;
    other[2].sigma_a *= 1.3;
    const std::vector<double> changed = coarse.rho(laws, 2, other[2]), again = coarse.rho(coarse.laws(other));
    for (std::size_t i = 0; i < chart.laminates.size(); ++i) {
        CHECK(std::abs(seen[i] - exact[i]) < 1e-3);
        CHECK(changed[i] == again[i]);
        const LaminateReflectance alone(std::span(&chart.laminates[i], 1), 0.4, 1.5);
        CHECK(alone.rho(alone.laws(media))[0] == seen[i]);
    }
}

TEST_CASE("The layer model's derivatives are those of its values") {
    const LayerChart chart = drawn_laminates(testing::wide_gamut_set(), 6, 3);
    LayerModel model(chart, 3, 0.4, 1.5);
    const Eigen::VectorXd start = model.unknowns_of(layer_start(chart, 3));
    Eigen::Matrix3Xd by(3, model.unknowns()), unused(3, model.unknowns());
    model.prepare(start, true);
    const Eigen::Vector3d colour = model.colour(2, by);
    for (Eigen::Index i = 0; i < start.size(); ++i) {
        Eigen::VectorXd up = start, down = start;
        const double step = 1e-3;
        up[i] += step, down[i] -= step;
        model.prepare(up, false);
        const Eigen::Vector3d above = model.colour(2, unused);
        model.prepare(down, false);
        const Eigen::Vector3d slope = (above - model.colour(2, unused)) / (2 * step);
        CAPTURE(i, colour.transpose());
        CHECK((by.col(i) - slope).norm() < 1e-3 * (0.003 + slope.norm()));
    }
}

TEST_CASE("Laminates drawn by a set are fitted and foretell others", "[slow]") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    const LayerFit fit = fit_layers(drawn_laminates(truth, 150, 1), {.name = "fitted", .channels = 4, .folds = 0});
    CHECK_NOTHROW(fit.set.validate());
    CHECK(fit.set.channels.size() == 4);
    CHECK(fit.fitted.mean < 1);
    const LayerCheck others = check_layers(fit.set, drawn_laminates(truth, 100, 2));
    CHECK(others.summary.mean < 1.2);
    CHECK(check_layers(fit.set, upside_down(drawn_laminates(truth, 100, 2))).summary.mean > 10 * others.summary.mean);
}

TEST_CASE("Measured laminates of five layers: what was not fitted is foretold, upside down it is not", "[slow]") {
    const LayerChart chart = measured_laminates();
    REQUIRE(chart.laminates.size() == 1024);
    CHECK(chart.roles == std::vector<std::string>{"White", "Yellow", "Magenta", "Cyan"});
    CHECK(laminate_text(chart, 1) == "White 0.08, White 0.08, White 0.08, White 0.08, Yellow 0.08, White 0.8");
    const LayerFitOptions options{.name = "fitted", .channels = 3, .folds = 0};
    const LayerChart fitted = some(chart, 0, 7), judged = some(chart, 3, 7);
    const double seen = check_layers(fit_layers(fitted, options).set, judged).summary.mean;
    const double turned = check_layers(fit_layers(upside_down(fitted), options).set, upside_down(judged)).summary.mean;
    INFO(seen << ", upside down " << turned);
    CHECK(seen < 2);
    CHECK(turned > 3 * seen);
}

TEST_CASE("Charts of laminates are read, and refused in one sentence") {
    const LayerChart chart = parse_layer_chart(
        "# illuminant: D65\nlayers,L,a,b\n\"Y 0.08, W 0.1, W 0.8\",92.5,-7,18\n\n\"C 0.08, W 0.8\",60,-30,-30\n",
        "t.csv");
    CHECK(chart.roles == std::vector<std::string>{"Y", "W", "C"});
    CHECK(chart.illuminant == optics::Illuminant::d65);
    REQUIRE(chart.laminates.size() == 2);
    CHECK(chart.laminates[0] == LayerLaminate{{0, 0.08}, {1, 0.1}, {1, 0.8}});
    CHECK(chart.lab(1, 2) == -30);
    CHECK_FALSE(is_layer_chart("W,C,L,a,b\n1,0,90,0,0\n"));
    const LayerChart german = parse_layer_chart("Titel\n\nlayers;L;a;b;\r\nY 0.08, W 0.8;92,5;-7;18;\r\n;;;;\r\n", "t",
                                                optics::Illuminant::d50);
    CHECK(german.laminates.size() == 1);
    CHECK(german.lab(0, 0) == 92.5);

    const auto refused = [](const std::string& text) {
        try {
            (void)parse_layer_chart(text, "t");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(refused("layers,L,a,b\nY 0.08,92,1,1\n\"Y 0.08 W\",1,2,3\n"),
               Contains("t: line 3: the layer \"Y 0.08 W\""));
    CHECK_THAT(refused("layers,L,a,b\nY 0.08,W 0.8,92,1,1\n"),
               Contains("t: line 2: has 5 cells") && Contains("stands in quotes"));
    CHECK_THAT(refused("layers,L,a,b\nY 0.08,bright,1,1\n"),
               Contains("t: line 2, column 2 (\"L\"): \"bright\" is no number"));
    CHECK_THAT(refused("layers,L,a,b\nY 0.08,900,1,1\n"), Contains("no colour that a print has"));
    CHECK_THAT(refused("layers,X,Y,Z\n"), Contains("begins with layers,L,a,b"));
    CHECK_THAT(refused("layers,L,a,b\n"), Contains("no laminate"));
    CHECK_THAT(refused("{\"voxels\": 3}"), Contains("palette and entries"));
    CHECK_THAT(refused("{\"entries\": [{\"recipe\": [3], \"lab\": [1, 2, 3]}], \"palette\": [{\"color\": \"White\"}], "
                       "\"layer_height_mm\": 0.08, \"base_channel_idx\": 0, \"base_layers\": 10}"),
               Contains("recipe"));
    CHECK_THROWS_WITH(fit_layers(chart, {.name = "few", .channels = 3}),
                      Contains("2 laminates are too few for 3 resins"));
    CHECK_THROWS_WITH(check_layers(optics::vero_opaque(), measured_laminates()), Contains("has no resin White"));
}

}  // namespace voxtone::calibration
