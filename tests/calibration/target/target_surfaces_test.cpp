// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_surfaces.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/target/target_file.h"
#include "calibration/target/target_job.h"
#include "calibration/target/target_scene.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

TargetOptions on_card(std::vector<std::string> roles) {
    TargetOptions options;
    options.roles = std::move(roles);
    options.pitch_um = {42.3, 84.7, 27};
    options.light = "white", options.dark = "black";
    options.surfaces = {parse_target_surface("white=smooth:0.85,0.84,0.8"),
                        parse_target_surface("black=matt+gap:0.03")};
    return options;
}

std::string fault(const TargetOptions& options) {
    try {
        (void)lay_out_target(options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

std::string fault(std::string_view surface) {
    try {
        (void)parse_target_surface(surface);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("Upon a card a target is its squares and markers, and says what it lies on") {
    const Target target = lay_out_target(on_card({"C", "M", "Y"}));
    CHECK(target.base_mm == 0);
    CHECK(target.height_mm() == Approx(0.675));
    REQUIRE(target.squares.size() == 2 * 3 * 3);  // halves, resins, thicknesses
    for (const TargetBox& box : target_boxes(target)) {
        CHECK(box.min_mm.z() == 0);
        CHECK((box.max_mm - box.min_mm).head<2>().maxCoeff() <= 10 + 1e-9);
    }
    CHECK(target.depth_mm(target.squares[0]) == Approx(2 * 0.027));
    CHECK(target.depth_mm(target.squares[2]) == Approx(15 * 0.027));
    CHECK(mixture_text(target.of_markers()) == "C:33.3333+M:33.3333+Y:33.3333");
    const std::string text = target_text(target);
    CHECK_THAT(text, Contains("\"kind\": \"matt+gap\""));
    const Target again = parse_target(text, "t.json");
    CHECK(target_text(again) == text);
    const Patch patch = patch_of(again, again.squares.back());
    REQUIRE(patch.on);
    CHECK(patch.on->name == "black");
    CHECK(patch.on->kind.gap);
    CHECK(patch.base_mm == 0);
    // White among the resins dilutes, as on a base of it; black is what markers are printed of.
    const Target diluted = lay_out_target(on_card({"C", "K", "W"}));
    CHECK(diluted.squares.size() == 2 * (3 + 2 + 1));
    CHECK(mixture_text(diluted.of_markers()) == "K");
}

TEST_CASE("A target upon a card shows the card, dark markers and squares as they are modelled") {
    const Target target = lay_out_target(on_card({"C", "M", "Y"}));
    const TargetColours colours = reflected_colours(target, optics::vero_opaque());
    CHECK(colours.light.isApprox(Eigen::Vector3d(0.85, 0.84, 0.8)));
    CHECK(colours.dark.isApprox(Eigen::Vector3d::Constant(0.03)));
    REQUIRE(colours.markers);
    CHECK(colours.markers->maxCoeff() < 0.3);
    REQUIRE(colours.squares.size() == target.squares.size());
    const TargetScene scene(target, colours);
    CHECK(scene.at(target.dark_half.min_mm + Eigen::Vector2d(0.5, 0.5)).isApprox(colours.dark));
    CHECK(scene.at(target.squares[0].area.center()).isApprox(colours.squares[0]));
    CHECK(colours.squares[0][0] > colours.squares[2][0] + 0.1);  // thin cyan and thick
}

TEST_CASE("What is wrong with a target's surfaces is one sentence") {
    CHECK_THAT(fault("white"), Contains("white=smooth:0.85"));
    CHECK_THAT(fault("white=shiny:0.8"), Contains("matt, smooth or a mirror"));
    CHECK_THAT(fault("white=matt:85"), Contains("from 0 to 1"));
    CHECK_THAT(fault("white=matt:0.8,0.8"), Contains("2 values"));
    CHECK_THAT(fault("C:10=matt:0.8"), Contains("no mixture"));
    TargetOptions options = on_card({"C", "M", "K"});
    options.dark = "K";
    CHECK_THAT(fault(options), Contains("--surface black would be ignored"));
    options.surfaces.pop_back();
    CHECK_THAT(fault(options), Contains("K is a resin, whose half would stand higher"));
    options = on_card({"C", "black"});
    CHECK_THAT(fault(options), Contains("a resin has this name"));
    options = on_card({"C"});
    options.surfaces[1] = options.surfaces[0];
    CHECK_THAT(fault(options), Contains("is there twice"));
    options = on_card({"C"});
    options.layout = TargetLayout::chart;
    CHECK_THAT(fault(options), Contains("chart"));
    TargetJob job;
    job.surfaces = {"white=matt:0.8"};
    job.out = "x", job.strips = true;
    CHECK_THROWS_WITH(job.validate(), Contains("--strips with --surface"));
    std::string text = target_text(lay_out_target(on_card({"C"})));
    text.replace(text.find("matt+gap"), 8, "velvet");
    CHECK_THROWS_WITH(parse_target(text, "t.json"), Contains("kind") && Contains("velvet"));
}
