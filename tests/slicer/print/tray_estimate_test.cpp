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

TEST_CASE("An estimate's sums are of its phases and of its parts, and the loop's share is told") {
    const TrayDesk desk;
    desk.write("box.obj", soft_box({0, 0, 0}, {6, 5, 4}));
    SliceOptions options = desk.options("box.obj");
    options.iterations = "2", options.predict = "transport", options.report = true;
    Progress progress;
    const JobEstimate one = estimate_job(options, progress, {.resins = false});
    const JobEstimate two = estimated(options, {{options.model, options.model}, 1});
    for (const JobEstimate* of : {&one, &two}) {
        double cpu_s = 0, seconds = 0;
        std::uint64_t memory = 0;
        for (const PhaseEstimate& phase : of->phases) {
            cpu_s += phase.cpu_s, seconds += phase.seconds;
            memory = std::max(memory, phase.memory_bytes);
            CHECK((phase.cpu_s >= 0 && phase.seconds >= 0));
        }
        CHECK(of->cpu_s == Approx(cpu_s));
        CHECK(of->seconds == Approx(seconds));
        CHECK(of->memory_bytes == memory);
        CHECK((of->loop && of->prediction && of->threads >= 1));
        REQUIRE(of->phases.size() > 4);
        CHECK((of->phases[0].phase == Phase::read && of->phases[0].measured && of->phases[0].seconds > 0));
        CHECK_FALSE(of->phases[1].measured);
        CHECK((of->loop_s > 0 && of->loop_s < of->seconds));
        CHECK(of->free_disk_bytes);
    }
    const auto seconds_of = [](const JobEstimate& of, Phase wanted) {
        const auto found = std::ranges::find(of.phases, wanted, &PhaseEstimate::phase);
        return found == of.phases.end() ? -1 : found->seconds;
    };
    for (const Phase phase : {Phase::separate, Phase::prepare_loop, Phase::loop, Phase::predict})
        CHECK(seconds_of(two, phase) == Approx(2 * seconds_of(one, phase)));
    CHECK(one.loop_s == Approx(seconds_of(one, Phase::prepare_loop) + seconds_of(one, Phase::loop)));
    CHECK(two.loop_s == Approx(2 * one.loop_s));
    CHECK(two.surface_mm2 == Approx(2 * one.surface_mm2));
    CHECK(one.surface_mm2 == Approx(2 * (30 + 24 + 20)));
    // Of what the body is, where resins were not asked for: as large as its box.
    CHECK(one.body_ml == Approx(0.12).epsilon(0.02));
    CHECK_THAT(one.why_no_resins, Contains("--quick"));
    CHECK(two.why_no_resins == one.why_no_resins);
    CHECK((one.resins.empty() && two.resins.empty() && !one.g));
    // A copy is no part: its layers alone are made, and they are quicker than the first one's.
    const JobEstimate copies = estimated(options, {{options.model}, 5});
    CHECK(seconds_of(copies, Phase::loop) == Approx(seconds_of(one, Phase::loop)));
    CHECK(seconds_of(copies, Phase::layers) == Approx(2 * seconds_of(one, Phase::layers)));
    CHECK(copies.disk_bytes > one.disk_bytes);
    CHECK(two.disk_bytes == Approx(2.0 * double(one.disk_bytes)));
}

TEST_CASE("Of a looped print the resins are those of its skin, and core below it") {
    const TrayDesk desk;
    desk.write("box.obj", soft_box({0, 0, 0}, {8, 7, 6}));
    SliceOptions options = desk.options("box.obj");
    options.core = "K";
    const auto ml_of = [](const JobEstimate& of, const char* role) {
        const auto found = std::ranges::find(of.resins, role, &ResinEstimate::role);
        return found == of.resins.end() ? 0 : found->ml;
    };
    Progress progress;
    const JobEstimate open = estimate_job(options, progress);
    options.iterations = "1";
    const JobEstimate looped = estimate_job(options, progress);
    // Below a millimetre all round lies black alone.
    constexpr double core_ml = 6 * 5 * 4 * 1e-3, all_ml = 8 * 7 * 6 * 1e-3;
    for (const JobEstimate* of : {&open, &looped}) {
        CHECK(of->body_ml == Approx(all_ml).epsilon(0.02));
        CHECK(ml_of(*of, "K") > 0.97 * core_ml);
        CHECK(ml_of(*of, "K") < core_ml + 0.5 * (all_ml - core_ml));
        // Of light colours white is most of the shell.
        CHECK(ml_of(*of, "W") > 0.4 * (all_ml - core_ml));
        CHECK((ml_of(*of, "M") > 0 && ml_of(*of, "Y") > 0));
    }
}

TEST_CASE("What is thinner than a voxel counts where it is kept, and only there") {
    const TrayDesk desk;
    // A sheet of a tenth of a voxel on a block.
    desk.write("thin.obj", soft_box({0, 0, 0}, {6, 5, 1}) + soft_box({3, 0, 1}, {3.004, 5, 6}, 9));
    SliceOptions options = desk.options("thin.obj");
    Progress progress;
    const double kept = estimate_job(options, progress, {.resins = false}).body_ml;
    options.keep_thin = false;
    const double lost = estimate_job(options, progress, {.resins = false}).body_ml;
    CHECK(lost == Approx(0.030).epsilon(0.03));
    CHECK(kept > lost + 0.0005);
}

TEST_CASE("Weights and prices of a tray are those of its resins, of all copies") {
    const TrayDesk desk;
    desk.write("box.obj", soft_box({0, 0, 0}, {3, 2, 1.5}));
    const SliceOptions options = desk.options("box.obj");
    const JobEstimate one = estimated(options, {{options.model}, 1}, true),
                      three = estimated(options, {{options.model}, 3}, true);
    REQUIRE(three.resins.size() == one.resins.size());
    double ml = 0, g = 0;
    for (std::size_t r = 0; r < one.resins.size(); ++r) {
        CHECK(three.resins[r].role == one.resins[r].role);
        CHECK(three.resins[r].ml == Approx(3 * one.resins[r].ml));
        REQUIRE(one.resins[r].g.has_value() == three.resins[r].g.has_value());
        if (one.resins[r].g) CHECK(*three.resins[r].g == Approx(3 * *one.resins[r].g));
        ml += one.resins[r].ml, g += one.resins[r].g.value_or(0);
    }
    CHECK(ml == Approx(one.body_ml));
    CHECK(one.body_ml == Approx(0.009).epsilon(0.03));
    if (one.g) {
        CHECK(*one.g == Approx(g));
        CHECK(*three.g == Approx(3 * *one.g));
    }
}

TEST_CASE("Trays that are filled are counted together, and told where they are more than one") {
    const TrayDesk desk;
    desk.write("box.obj", soft_box({0, 0, 0}, {3, 2, 1.5}));
    SliceOptions options = desk.options("box.obj");
    options.trays = 3;
    const JobEstimate one = estimated(options, {{options.model}, 4});
    CHECK_THAT(fmt::format("{}", fmt::join(one.notes, "\n")), !Contains("are filled"));
    desk.write("plate.json", R"({"format": "voxtone-printer", "version": 1, "name": "small", "tray_mm": [9, 7, 20],
        "pitch_um": [42.333, 84.667, 27], "max_resins": 6, "max_colours": 6, "min_layers": 30, "formats": ["png"],
        "background_rgb": [0, 0, 0], "default_roles": ["C", "M", "Y", "K", "W"]})");
    options.printer = desk / "plate.json";
    options.resins = "vero-opaque";
    const JobEstimate two = estimated(options, {{options.model}, 5});
    CHECK_THAT(fmt::format("{}", fmt::join(two.notes, "\n")), Contains("2 trays are filled"));
    CHECK(two.layers == 2 * one.layers);
    CHECK(two.size_px[2] == one.layers);
    CHECK(two.size_mm[2] == Approx(one.layers * 0.027));
    CHECK(two.layer_um == Approx(27));
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
