// SPDX-License-Identifier: GPL-3.0-or-later
//
// An estimate of made-up figures, no two of which are alike: each stands where it belongs, in its unit.
#include "slicer/print/estimate_text.h"

#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using nlohmann::json;

namespace {

JobEstimate made_up() {
    JobEstimate e;
    e.model = "cow.obj", e.printer = "stratasys-j750-hm";
    e.size_mm = {12.5, 8.25, 4}, e.size_px = {296, 98, 148};
    e.first_layer = 7, e.layers = 141, e.layer_um = 27;
    e.surface_mm2 = 360;
    e.body_ml = 0.413;
    e.resins = {{"C", "Cyan", 0.1125, 0.13, 0.05}, {"W", "White", 0.3, 0.35, 0.07}};
    e.g = 0.48, e.price = 0.12, e.currency = "EUR";
    e.printing.passes_of_layer = 2, e.printing.passes = 282, e.printing.source = "measured";
    e.support_ml = 0.0625;
    e.loop = true;
    e.phases = {{Phase::separate, 3, 2, 100u << 20, true}, {Phase::loop, 50, 30, 300u << 20, false}};
    e.threads = 4, e.cpu_s = 53, e.seconds = 32, e.loop_s = 30;
    e.memory_bytes = 300u << 20, e.disk_bytes = 5'000'000, e.free_disk_bytes = 70'000'000;
    e.warnings = {"a warning"}, e.notes = {"a note"};
    return e;
}

/// The line that holds these words; words are told apart by one blank.
std::string line_with(const std::string& text, const std::string& words) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.find(words) == std::string::npos) continue;
        std::string one;
        std::istringstream parts(line);
        for (std::string word; parts >> word;) one += (one.empty() ? "" : " ") + word;
        return one;
    }
    return "no line with " + words;
}

Orientation turned(std::string rotate, double width_mm) {
    Orientation o;
    o.rotate = std::move(rotate);
    o.size_mm = {width_mm, 5, 4};
    o.layers = 148, o.passes = 296, o.under_ml = 0.5, o.downward_mm2 = 150, o.coloured_down_mm2 = 25;
    return o;
}

}  // namespace

TEST_CASE("An estimate tells people each of its figures in its unit") {
    const std::string text = estimate_text(made_up());
    CHECK(line_with(text, "cow.obj") == "cow.obj: 12.50 x 8.25 x 4.00 mm, 296 x 98 px, 141 layers of 27 um");
    CHECK(line_with(text, "surface") == "coloured surface 3.6 cm2");
    CHECK(line_with(text, "Cyan") == "C Cyan 0.113 ml 0.130 g 0.05 EUR");
    CHECK(line_with(text, "White") == "W White 0.300 ml 0.350 g 0.07 EUR");
    CHECK(line_with(text, "all ") == "all 0.413 ml 0.480 g 0.12 EUR");
    CHECK_THAT(line_with(text, "support"), Contains("some 0.0625 ml below what hangs over"));
    CHECK_THAT(line_with(text, "printing:"), Contains("282 passes of the heads, 2 a layer"));
    CHECK(line_with(text, "separate colours") == "separate colours 2.0 s 3.0 s 100 MiB (measured)");
    CHECK(line_with(text, "appearance loop") == "appearance loop 30 s 50 s 300 MiB");
    CHECK_THAT(text, Contains("32 s") && Contains("53 s") && Contains("300 MiB  on 4 threads\n"));
    CHECK(line_with(text, "on disk") == "up to 5.0 MB on disk (70 MB free)");
    CHECK_THAT(text, !Contains("orientations") && !Contains("density"));
}

TEST_CASE("What an estimate does not know it leaves out, or says why") {
    JobEstimate e = made_up();
    e.g = e.price = {}, e.resins[0].g = {}, e.resins[0].price = {};
    e.threads = 1, e.support_ml = {}, e.free_disk_bytes = {}, e.printing = {};
    const std::string text = estimate_text(e);
    CHECK(line_with(text, "Cyan") == "C Cyan 0.113 ml");
    CHECK(line_with(text, "all ") == "all 0.413 ml");
    CHECK_THAT(text, Contains("no weight") && Contains("density_g_per_ml") && Contains("on 1 thread\n"));
    CHECK_THAT(text, !Contains("support") && !Contains("printing:") && EndsWith("up to 5.0 MB on disk\n"));
    // Of no resins it is not said that one lacks a density.
    e.resins.clear();
    e.why_no_resins = "Which resins a layered print takes is known when it is made.";
    CHECK_THAT(estimate_text(e), Contains("\n  " + e.why_no_resins + "\n") && !Contains("no weight"));
    CHECK_THAT(estimate_summary(e), Contains("0.413 ml; about"));
}

TEST_CASE("An estimate in one line has what matters before a job starts") {
    JobEstimate e = made_up();
    const std::string line = estimate_summary(e);
    CHECK_THAT(line, Contains("12.50 x 8.25 x 4.00 mm, 296 x 98 px, 141 layers of 27 um; 3.6 cm2 of coloured surface; "
                              "0.413 ml (C 0.113, W 0.3), 0.12 EUR; 282 passes of the heads"));
    CHECK_THAT(line, EndsWith("; about 32 s on 4 threads and 300 MiB of memory, up to 5.0 MB on disk (70 MB free)"));
    CHECK_THAT(line, !Contains("\n"));
    e.threads = 1, e.price = {}, e.printing = {};
    CHECK_THAT(estimate_summary(e), Contains("W 0.3); about 32 s on 1 thread and"));
    // Of the loop, where it takes so long that somebody might want less of it.
    CHECK_THAT(loop_advice(e), Contains("about 30 s of that") && Contains("--iterations 0"));
    e.loop_s = 19;
    CHECK(loop_advice(e).empty());
    e.loop_s = 21;
    CHECK_FALSE(loop_advice(e).empty());
}

TEST_CASE("Orientations are a table with their views, and the advice") {
    JobEstimate e = made_up();
    e.orientations = {turned("x90", 12.5), turned("", 8), turned("z180", 6)};
    e.orientations[0].front = {"##", "#"};
    e.orientations[1].front = {"O"};
    e.orientations[1].as_it_is = true;
    e.orientations[2].fits = false, e.orientations[2].passes = 0;
    e.advised_orientation = OrientationAdvice{"x90", "fewest layers"};
    std::string text = estimate_text(e);
    CHECK_THAT(text, Contains("the body takes 0.413 ml in each"));
    CHECK(line_with(text, "12.5 x 5.0") == "x90 12.5 x 5.0 x 4.0 mm 148 296 0.50 ml 1.50 cm2 0.25 cm2");
    CHECK_THAT(line_with(text, "8.0 x 5.0"), Contains("(as it is)"));
    CHECK(line_with(text, "6.0 x 5.0") == "z180 6.0 x 5.0 x 4.0 mm 148 - 0.50 ml 1.50 cm2 0.25 cm2 does not fit");
    // The topmost line of letters first, what is lower stands on the same ground.
    CHECK_THAT(text, Contains("\n  ##\n  #             O\n  x90           as it is      z180\n"));
    CHECK(line_with(text, "recommended") == "recommended: --rotate x90: fewest layers");
    e.orientations[0].as_it_is = true;
    CHECK(line_with(estimate_text(e), "recommended") == "recommended: leave it as it is: fewest layers");
    e.advised_orientation = {};
    text = estimate_text(e);
    CHECK_THAT(text, EndsWith("none of them fits\n") && !Contains("recommended"));
    // Six in a row: the seventh begins another.
    e.orientations.assign(7, turned("y90", 5));
    text = estimate_text(e);
    CHECK_THAT(text, Contains("\n  y90\n") && !Contains(std::string(14 * 6, ' ')));
}

TEST_CASE("An estimate tells programs the same figures") {
    JobEstimate e = made_up();
    e.orientations.assign(6, turned("x90", 12.5));
    e.advised_orientation = OrientationAdvice{"x90", "fewest layers"};
    const std::string text = estimate_json(e);
    CHECK(io::schema_faults("estimate", text) == std::vector<std::string>{});
    const json told = json::parse(text);
    CHECK(told["model"] == "cow.obj");
    CHECK(told["printer"] == "stratasys-j750-hm");
    CHECK(told["size_mm"] == json({12.5, 8.25, 4.0}));
    CHECK(told["size_px"] == json({296, 98, 148}));
    CHECK((told["first_layer"] == 7 && told["layers"] == 141 && told["layer_um"] == 27));
    CHECK((told["surface_mm2"] == 360 && told["ml"] == 0.413 && told["g"] == 0.48 && told["price"] == 0.12));
    CHECK(told["currency"] == "EUR");
    CHECK(told["resins"][0] == json({{"role", "C"}, {"name", "Cyan"}, {"ml", 0.1125}, {"g", 0.13}, {"price", 0.05}}));
    CHECK(told["printing"] == json({{"passes_per_layer", 2}, {"passes", 282}, {"source", "measured"}}));
    CHECK((told["support_ml"] == 0.0625 && told["loop"] == true && told["prediction"] == false));
    CHECK(told["phases"][1] == json({{"name", "appearance loop"},
                                     {"cpu_seconds", 50.0},
                                     {"seconds", 30.0},
                                     {"memory_bytes", 300u << 20},
                                     {"measured", false}}));
    CHECK((told["threads"] == 4 && told["cpu_seconds"] == 53 && told["seconds"] == 32));
    CHECK((told["memory_bytes"] == 300u << 20 && told["disk_bytes"] == 5'000'000));
    CHECK(told["free_disk_bytes"] == 70'000'000);
    CHECK(told["orientations"][0]["rotate"] == "x90");
    CHECK((told["orientations"][0]["passes"] == 296 && told["orientations"][0]["under_ml"] == 0.5));
    CHECK((told["orientations"][0]["downward_mm2"] == 150 && told["orientations"][0]["coloured_down_mm2"] == 25));
    CHECK(told["advised_orientation"]["reason"] == "fewest layers");
    CHECK((told["warnings"] == json({"a warning"}) && told["notes"] == json({"a note"})));
    // What is not known has no key, and no 0.
    JobEstimate bare = made_up();
    bare.g = bare.price = bare.support_ml = {}, bare.free_disk_bytes = {};
    bare.currency.clear(), bare.resins.clear(), bare.printing = {};
    const json less = json::parse(estimate_json(bare));
    for (const char* key : {"g", "price", "currency", "support_ml", "free_disk_bytes", "printing", "orientations",
                            "advised_orientation", "why_no_resins"}) {
        CAPTURE(key);
        CHECK_FALSE(less.contains(key));
    }
}
