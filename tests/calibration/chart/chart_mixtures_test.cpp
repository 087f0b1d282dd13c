// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_mixtures.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <set>

#include "base/error.h"
#include "calibration/chart/chart_order.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/target_file.h"
#include "tests/calibration/chart/chart_samples.h"

namespace voxtone::calibration {
namespace {

using Catch::Contains;

ChartFitOptions order_options() {
    ChartFitOptions options;
    options.lengths_from = optics::vero_opaque();
    return options;
}

/// A chart of 6 x 10 places in row order, read by an instrument.
PatchTable placed_chart() {
    PatchTable table = testing::drawn_chart(testing::wide_gamut_set(), 60, 4, 0.3);
    for (std::size_t p = 0; p < table.patches.size(); ++p)
        table.patches[p].row = static_cast<int>(p / 10) + 1, table.patches[p].column = static_cast<int>(p % 10) + 1;
    return table;
}

std::string refusal_of(const PatchTable& table) {
    try {
        expect_order(table, order_options());
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("A chart holds every solid and half once, and no mixture twice, larger charts hold the smaller ones") {
    const optics::ResinSet set = optics::vero_opaque();
    CHECK(least_chart_patches(5) == 15);
    const auto chart = chart_mixtures(set, 60);
    REQUIRE(chart.size() == 60);
    CHECK(std::set(chart.begin(), chart.end()).size() == 60);
    for (const std::vector<int>& mixture : chart) {
        CHECK(std::accumulate(mixture.begin(), mixture.end(), 0) == 100);
        CHECK(*std::min_element(mixture.begin(), mixture.end()) >= 0);
    }
    CHECK(std::count_if(chart.begin(), chart.end(),
                        [](const auto& m) { return *std::max_element(m.begin(), m.end()) == 100; }) == 5);
    const auto small = chart_mixtures(set, 30);
    CHECK(std::equal(small.begin(), small.end(), chart.begin()));
    // What is seen counts: with one grey resin twice, mixtures of the two are of little use.
    optics::ResinSet twins = set;
    twins.resins[1].sigma_t_per_mm = twins.resins[0].sigma_t_per_mm;
    twins.resins[1].albedo = twins.resins[0].albedo;
    CHECK(chart_mixtures(twins, 60) != chart);
}

TEST_CASE("A chart that was measured turned, mirrored or by columns is refused by that name") {
    const PatchTable right = placed_chart();
    CHECK(refusal_of(right).empty());
    const auto in_order = [&](auto&& place) {
        PatchTable table = right;
        for (std::size_t p = 0; p < table.patches.size(); ++p) table.patches[p].rho = right.patches[place(p)].rho;
        return refusal_of(table);
    };
    CHECK_THAT(in_order([](std::size_t p) { return 59 - p; }), Contains("measured turned by 180 degrees"));
    CHECK_THAT(in_order([](std::size_t p) { return p / 10 * 10 + 9 - p % 10; }), Contains("left for right"));
    CHECK_THAT(in_order([](std::size_t p) { return (5 - p / 10) * 10 + p % 10; }), Contains("top for bottom"));
    CHECK_THAT(in_order([](std::size_t p) { return p % 6 * 10 + p / 6; }), Contains("column by column"));
    // Without places nothing can be said.
    PatchTable placeless = right;
    for (Patch& patch : placeless.patches) patch.row = patch.column = 0;
    for (std::size_t p = 0; p < 60; ++p) placeless.patches[p].rho = right.patches[59 - p].rho;
    CHECK(refusal_of(placeless).empty());
}

TEST_CASE("A chart's layout is read back, row by row from the upper left, and its form is a chart of its own") {
    TargetOptions options;
    options.layout = TargetLayout::chart;
    options.roles = {"C", "W", "K"};
    options.pitch_um = {42.333, 84.667, 27};
    for (int percent = 5; percent < 100; percent += 5)
        options.chart.push_back({{"C", percent / 100.0}, {"W", 1 - percent / 100.0}});
    const Target target = lay_out_target(options);
    CHECK(target.is_chart());
    CHECK(target.squares.size() == 19);
    CHECK(target_text(parse_target(target_text(target), "t")) == target_text(target));
    const auto places = square_places(target);
    CHECK(places[0] == std::array{1, 1});
    CHECK(places[1] == std::array{1, 2});
    CHECK(std::is_sorted(places.begin(), places.end()));
    for (const TargetBox& box : target_boxes(target)) CHECK(box.max_mm.x() > box.min_mm.x());

    const std::string form = "patch,row,column,C,W,L,a,b\n1,1,1,0.05,0.95,80,-5,-9\n2,1,2,1,0,,,\n";
    const PatchTable table = parse_patches(form, "form.csv");
    REQUIRE(table.patches.size() == 1);
    CHECK(table.patches[0].column == 1);
    CHECK_THAT(table.notes.front(), Contains("1 patches have no colour"));
    CHECK_THROWS_WITH(parse_patches("patch,row,column,C,W,L,a,b\n1,1,1,0.05,0.95,,,\n", "form.csv"),
                      Contains("no patch is measured yet"));
}

}  // namespace voxtone::calibration
