// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/tray_estimate.h"

#include <algorithm>

#include <fmt/ranges.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/slicer/plate/tray_desk.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

JobEstimate estimated(const SliceOptions& options, const TrayModels& models = {}, bool resins = false) {
    Progress progress;
    return estimate_tray(options, models, progress, {.resins = resins});
}

}  // namespace

TEST_CASE("Parts of a tray that cannot be printed are said at once, and the others are estimated, as slice does") {
    const TrayDesk desk;
    desk.write("good.obj", soft_box({0, 0, 0}, {6, 4, 3}));
    desk.write("metres.obj", soft_box({0, 0, 0}, {72, 50, 20}));
    desk.write("broken.obj", "this is no model\n");
    desk.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [{"model": "good.obj"},
        {"model": "metres.obj", "unit": "m"}, {"model": "broken.obj"}, {"model": "gone.obj"}]})");
    const JobEstimate rest = estimated(desk.options("tray.json"));
    REQUIRE(rest.faults.size() == 3);
    CHECK_THAT(rest.faults[0],
               Contains("parts[1]: metres.obj: the model is") && Contains("As mm (--unit mm) it is 72 x 50 x 20 mm"));
    CHECK_THAT(rest.faults[1], Contains("broken.obj"));
    CHECK_THAT(rest.faults[2], Contains("gone.obj"));
    CHECK_THAT(fmt::format("{}", fmt::join(rest.warnings, "\n")),
               Contains("metres: fails, and the tray is made without it") && Contains("gone: fails") &&
                   !Contains("good: fails"));
    CHECK(rest.exit_code == ExitCode::invalid_input);
    const JobEstimate alone = estimated(desk.options(""), {{desk / "good.obj"}, 1});
    CHECK(rest.body_ml == alone.body_ml);
    CHECK((rest.layers == alone.layers && alone.exit_code == ExitCode::done && alone.faults.empty()));
    // Where nothing is left, or none may be left out, there is nothing to estimate.
    const auto refused = [&](const std::string& parts, bool fail_fast) {
        desk.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [)" + parts + "]}");
        SliceOptions options = desk.options("tray.json");
        options.fail_fast = fail_fast;
        try {
            (void)estimated(options);
            return std::string();
        } catch (const Error& error) {
            return std::string(error.what());
        }
    };
    CHECK_THAT(refused(R"({"model": "gone.obj"})", false), Contains("none of the tray's parts can be printed"));
    CHECK_THAT(refused(R"({"model": "good.obj"}, {"model": "gone.obj"})", true), Contains("gone.obj"));
}

TEST_CASE("What a tray takes at the printer is told: passes over its layers, and support of all copies") {
    const TrayDesk desk;
    // A table of 8 x 4 mm on a leg of 2 x 4: below it is as much air beside the leg.
    desk.write("table.obj", soft_box({3, 0, 0}, {5, 4, 2}) + soft_box({0, 0, 2}, {8, 4, 3}, 9));
    const SliceOptions options = desk.options("table.obj");
    const JobEstimate one = estimated(options, {{options.model}, 1});
    CHECK(one.printer == "stratasys-j750-hm");
    CHECK(one.printing.passes_of_layer == 1);
    CHECK(one.printing.passes == one.layers);
    CHECK_FALSE(one.printing.seconds);
    REQUIRE(one.support_ml);
    CHECK(*one.support_ml == Approx(6 * 4 * 2 * 1e-3).epsilon(0.05));
    const JobEstimate many = estimated(options, {{options.model}, 12});
    CHECK(many.printing.passes == one.printing.passes);  // beside each other, along the heads' way
    CHECK(*many.support_ml == Approx(12 * *one.support_ml));
    // Units and warnings that are said on the way are of the part that was named before them.
    SaidProgress progress;
    (void)estimate_tray(options, {{options.model}, 2}, progress, {.resins = false});
    CHECK_THAT(progress.notes(), Catch::Matchers::StartsWith("part table\n") && Contains("unit: "));
    CHECK(many.body_ml == Approx(12 * one.body_ml));
}

TEST_CASE("estimate refuses what slice refuses: too little memory for the loop, fewer layers than the printer takes") {
    const TrayDesk desk;
    desk.write("box.obj", soft_box({0, 0, 0}, {40, 30, 20}));
    SliceOptions options = desk.options("box.obj");
    options.iterations = "auto";
    options.memory_gib = 0.1;
    Progress progress;
    CHECK_THROWS_AS(estimate_job(options, progress, {.resins = false}), ResourceError);
    CHECK_THROWS_WITH(estimate_job(options, progress, {.resins = false}),
                      Contains("GiB of memory at the least, and 102 MiB are allowed"));
    options.iterations = "0";
    CHECK(estimate_job(options, progress, {.resins = false}).layers > 30);
    desk.write("sheet.obj", soft_box({0, 0, 0}, {4, 3, 0.4}));
    options = desk.options("sheet.obj");
    CHECK_THROWS_WITH(estimate_job(options, progress, {.resins = false}), Contains("takes no fewer than 30"));
    CHECK_THROWS_WITH(estimated(options, {{options.model}, 2}),
                      Contains("takes no fewer than 30") && Contains("larger (\"size\")"));
    // To see which way it has enough.
    CHECK(estimate_job(options, progress, {.orientations = true, .resins = false}).advised_orientation);
    // Said, as slice says it: small, in a unit that was assumed.
    SaidProgress said;
    desk.write("small.obj", soft_box({0, 0, 0}, {1, 1, 1.2}));
    const JobEstimate small = estimate_job(desk.options("small.obj"), said, {.resins = false});
    REQUIRE_FALSE(small.warnings.empty());
    CHECK_THAT(small.warnings[0], Contains("[tiny]"));
    CHECK_THAT(said.notes(), Contains("mm assumed"));
    CHECK_THAT(said.warnings(), Contains("[tiny]"));
}

TEST_CASE("A model of one resin is counted as that, and stands in its place") {
    const TrayDesk desk;
    desk.write("block.obj", soft_box({0, 0, 0}, {8, 6, 4}));
    desk.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "resins": "vero-opaque-clear",
        "load": "C,M,Y,K,W,T", "parts": [{"model": "block.obj", "resin": "T", "copies": 2}]})");
    const JobEstimate estimate = estimated(desk.options("tray.json"), {}, true);
    const auto clear = std::ranges::find(estimate.resins, "T", &ResinEstimate::role);
    REQUIRE(clear != estimate.resins.end());
    CHECK(clear->ml == Approx(2 * 8 * 6 * 4 * 1e-3).epsilon(0.02));
    CHECK(estimate.body_ml == Approx(clear->ml));
    CHECK_FALSE(estimate.loop);
}
