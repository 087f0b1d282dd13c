// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slabs that are read by the light that comes through them, beside the squares of a target.
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/fit/resin_fit.h"
#include "calibration/patches/patch_file.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

// Of white and black of vero-opaque by adding-doubling that shares no code,
// benchmarks/calibration/target/layered_judge.py.
const std::string squares =
    "top,backing,thickness_mm,R,G,B\n"
    "W,W,0.675,0.80655,0.88319,0.79727\nK,W,0.675,0.01187,0.01144,0.01104\n"
    "W,K,0.675,0.38062,0.49350,0.70058\nK,K,0.675,0.01089,0.01089,0.01089\n"
    "W:50+K:50,W,0.675,0.05546,0.06667,0.11964\nW:50+K:50,K,0.675,0.05103,0.06505,0.11961\n";
const std::string slabs =
    "W,beam,0.2,0.66966,0.60271,0.42652\nW,light,0.2,0.60215,0.54413,0.39051\n"
    "W,beam,1,0.38635,0.32066,0.13236\nW,light,1,0.35413,0.29419,0.12138\n";

}  // namespace

TEST_CASE("light that comes through slabs tells white's extinction more nearly than squares alone") {
    const ResinFit alone = fit_resins(parse_patches(squares, "squares.csv"), {}),
                   both = fit_resins(parse_patches(squares + slabs, "both.csv"), {});
    constexpr double sigma_t[] = {6, 9, 24}, albedo[] = {0.9991, 0.9997, 0.999};
    const auto w = static_cast<std::size_t>(both.set.find("W"));
    for (std::size_t c = 0; c < 3; ++c) {
        CAPTURE(c);
        CHECK(both.set.resins[w].sigma_t_per_mm[c] == Approx(sigma_t[c]).epsilon(0.01));
        CHECK(both.set.resins[w].albedo[c] == Approx(albedo[c]).margin(2e-4));
        CHECK(both.chi2[c] < 0.1);
        const auto of_alone = static_cast<std::size_t>(alone.set.find("W"));
        CHECK(both.resins[w].sigma_t[c].standard_error < 0.7 * alone.resins[of_alone].sigma_t[c].standard_error);
    }
}

TEST_CASE("slabs in light from behind are rows of a target's table, and no bases") {
    const PatchTable table = parse_patches(squares + slabs, "both.csv");
    REQUIRE(table.patches.size() == 10);
    CHECK(table.patches[6].lit == optics::LightThrough::beam);
    CHECK(table.patches[7].lit == optics::LightThrough::diffuse);
    CHECK(table.patches[6].backing.empty());
    CHECK(patch_name(table.patches[6]) == "W of 0.2 mm, beam");
    const PatchTable again = parse_patches(patch_table_text(table, ""), "again.csv");
    REQUIRE(again.patches.size() == 10);
    CHECK(again.patches[7].lit == optics::LightThrough::diffuse);
    const auto refused = [](const std::string& row, const std::string& why) {
        CHECK_THROWS_WITH(parse_patches("top,backing,thickness_mm,base_mm,R,G,B\n" + row, "t.csv"), Contains(why));
    };
    refused("W,beam,0.2,5,0.5,0.5,0.5\n", "lies on nothing");
    refused("W,light,0.2,0,1.2,0.5,0.5\n", "more than all light");
    refused("W,lights,0.2,0,0.5,0.5,0.5\nW,light,0.2,0,0.4,0.5,0.5\nW,light,0.2,0,0.5,0.5,0.5\n", "measured already");
    PatchTable divided = table;
    apply_white_reference(divided, 0.9);
    CHECK(divided.patches[0].rho[0] == Approx(0.9 * 0.80655));
    CHECK(divided.patches[6].rho[0] == 0.66966);
}
