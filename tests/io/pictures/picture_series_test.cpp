// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers of other programs by their names: order, gaps, and what lies beside them.
#include "io/pictures/picture_series.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

using Names = std::vector<std::string>;

/// Names of the layers `first` to `last`.
Names numbered(const std::string& form, int first, int last) {
    Names names;
    for (int i = first; i <= last; ++i) names.push_back(fmt::format(fmt::runtime(form), i));
    return names;
}

Names operator+(Names a, const Names& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// The series in a folder of these files, which are listed in a wild order.
PictureSeries series_in(Names files) {
    std::ranges::sort(files, {}, [](const std::string& name) { return std::hash<std::string>()(name); });
    return find_series(files);
}

/// All that is said of them, one sentence a line.
std::string said(const Names& files) {
    const PictureSeries series = series_in(files);
    std::string text;
    for (const std::string& gap : series_gaps(series.names)) text += gap + "\n";
    for (const std::string& doubt : series_doubts(series.names, series.strangers)) text += doubt + "\n";
    return text;
}

}  // namespace

TEST_CASE("Layers are in the order of their numbers, wherever these stand") {
    for (const char* form :
         {"slice_{}.png", "slice_{:04}.png", "{}.png", "slice ({}).png", "slice{}.PNG", "x_12_{}.png", "x_{}_12.png",
          "v1.2_{}_final.png", "2026.11.26-{:03}-white.png", "slice-{}.png"}) {
        INFO(form);
        const Names names = numbered(form, 1, 120);
        CHECK(series_in(names).names == names);
        CHECK(said(names).empty());
    }
    const Names heights{"slice-0mm.png",     "slice-0.027mm.png", "slice-0.054mm.png",
                        "slice-0.081mm.png", "slice-0.108mm.png", "slice-0.135mm.png"};
    CHECK(series_in(heights).names == heights);
    CHECK(said(heights).empty());
    const Names unequal{"z0.5.png", "z1.png", "z1.5.png", "z2.png", "z10.png"};
    CHECK(series_in(unequal).names == unequal);
    const Names commas{"a_0,9.png", "a_1,0.png", "a_1,1.png", "a_10,2.png"};
    CHECK(series_in(commas).names == commas);
    const Names thousands{"s_998.png", "s_999.png", "s_1.000.png", "s_1.001.png"};
    CHECK(series_in(thousands).names == thousands);
    CHECK(said(thousands).empty());
    const Names with_height{"s_1_0.03mm.png", "s_2_0.05mm.png", "s_3_0.08mm.png", "s_4_0.11mm.png"};
    CHECK(series_in(with_height).names == with_height);
    CHECK(said(with_height).empty());
    const Names long_numbers{"t99999999999999999999.png", "t100000000000000000000.png", "t100000000000000000001.png"};
    CHECK(series_in(long_numbers).names == long_numbers);
    const Names mixed_case{"slice_1.png", "Slice_2.png", "SLICE_3.PNG"};
    CHECK(series_in(mixed_case).names == mixed_case);
    CHECK(series_in({"preview.png", "readme.txt"}).names.empty());
}

TEST_CASE("Every second layer, and layers by their height, have no gaps") {
    CHECK(said({"a_0.png", "a_2.png", "a_4.png", "a_6.png"}).empty());
    CHECK(said({"h_27.png", "h_54.png", "h_81.png", "h_108.png"}).empty());
    CHECK(said({"h_14.png", "h_27.png", "h_41.png", "h_54.png", "h_68.png"}).empty());  // 13.5 um, rounded
    CHECK(said({"only_7.png"}).empty());
}

TEST_CASE("Missing numbers are named") {
    const auto without = [](const std::string& form, std::vector<int> lost) {
        Names names;
        for (int i = 1; i <= 60; ++i)
            if (std::ranges::find(lost, i) == lost.end()) names.push_back(fmt::format(fmt::runtime(form), i));
        return names;
    };
    CHECK_THAT(said(without("slice_{}.png", {17})),
               Contains("number 17 is missing between slice_16.png and slice_18.png"));
    CHECK_THAT(said(without("slice_{:04}.png", {17, 18, 20, 30, 31, 32})),
               Contains("6 numbers are missing (17, 18, 20, 30 to 32), the first behind slice_0016.png"));
    CHECK_THAT(said({"z0.027.png", "z0.054.png", "z0.108.png", "z0.135.png"}), Contains("number 0.081 is missing"));
    CHECK_THAT(said({"a_1.png", "a_2.png", "a_5.png", "a_8.png", "a_11.png"}), Contains("6 numbers are missing"));
    CHECK_THAT(said({"a_0.png", "a_2.png", "a_6.png", "a_8.png"}), Contains("number 4 is missing"));
    CHECK_THAT(said(without("slice_{}.png", {5, 10, 15, 20, 25, 30, 35, 40, 45, 50})), Contains("and 2 more gaps"));
    // A stray of a far number does not hang or overflow.
    CHECK_THAT(said({"a_1.png", "a_2.png", "a_3.png", "a_999999999999999999.png"}), Contains("numbers are missing"));
}

TEST_CASE("Files that look like layers and are left out are counted, with the first and the last") {
    const Names layers = numbered("slice_{}.png", 1, 60);
    CHECK_THAT(said(layers + numbered("b_{}.png", 1, 40)),
               Contains("40 files are left out as another series: b_1.png to b_40.png") && Contains("slice_1.png"));
    CHECK_THAT(said(numbered("a_{}.png", 1, 60) + numbered("b_{}.png", 1, 60)),
               Contains("60 files") && Contains("b_1"));
    CHECK_THAT(said(layers + Names{"slice_61.tif"}), Contains("1 file is left out as no PNG: slice_61.tif"));
    CHECK_THAT(said(layers + numbered("slice_{}.bmp", 61, 70)), Contains("10 files are left out as no PNG"));
    CHECK_THAT(said(layers + numbered("slice_{:04}.png", 1, 9)),
               Contains("9 files are left out for a number that is there already: slice_0001.png to slice_0009.png"));
    CHECK_THAT(said(layers + Names{"Slice_7.png"}), Contains("left out for a number") && Contains("Slice_7.png"));
    CHECK_THAT(said(layers + Names{"slice_final.png"}), Contains("for want of a number: slice_final.png"));
    CHECK_THAT(said(layers + Names{"slice_7 (1).png"}), Contains("another series: slice_7 (1).png"));
    // Parts of one layer each: the series of the first part is taken.
    const Names parts = numbered("x_{}_1.png", 1, 30) + numbered("x_{}_2.png", 1, 30) + numbered("x_{}_3.png", 1, 30);
    CHECK(series_in(parts).names == numbered("x_{}_1.png", 1, 30));
    CHECK_THAT(said(parts), Contains("x_1_2.png to x_30_2.png") && Contains("x_1_3.png to x_30_3.png"));
    Names many = layers;
    for (char c = 'a'; c < 'k'; ++c) many = many + numbered(std::string(1, c) + "{}.png", 1, 3);
    CHECK_THAT(said(many), Contains("6 more series"));
    // What nobody takes for a layer.
    CHECK(said(layers + Names{".DS_Store", "._slice_1.png", "Thumbs.db", "readme.txt", "job_2.json"}).empty());
}

TEST_CASE("The writing that most files have is taken where a number is there twice") {
    const Names padded = numbered("slice_{:04}.png", 1, 60), plain = numbered("slice_{}.png", 1, 60);
    CHECK(series_in(padded + plain).names == padded);
    CHECK(series_in(plain + Names{"slice_0007.png"}).names == plain);
    CHECK(series_in(plain + Names{"slice_7.PNG"}).names == plain);
    CHECK_THAT(said(padded + plain), Contains("60 files are left out for a number"));
}

TEST_CASE("Numbers below 0 are in order and told") {
    const Names below = numbered("slice_{}.png", -30, -1), above = numbered("slice_{}.png", 0, 29);
    CHECK(series_in(above + below).names == below + above);
    CHECK_THAT(said(above + below),
               Contains("30 of 60 layers have numbers below 0") && Contains("slice_-30.png") && !Contains("missing"));
    // A dash is no minus.
    const Names dashed = numbered("slice-{}.png", 1, 30);
    CHECK(series_in(dashed).names == dashed);
    CHECK(said(dashed).empty());
}

TEST_CASE("A folder without PNG is told by what it has") {
    CHECK(other_pictures(numbered("slice_{}.tif", 1, 60)) == "60 files like slice_1.tif");
    CHECK(other_pictures(numbered("slice_{}.txt", 1, 60)).empty());
    CHECK(other_pictures(Names{}).empty());
}
