// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a job has an appearance loop and of which kind, and how what it takes goes with the print.
#include "slicer/part/loop_plan.h"

#include <catch2/catch.hpp>

#include "slicer/options/auto_limits.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Eigen::Vector3d;
using Eigen::Vector3f;
using voxtone::test::body_of;
using voxtone::test::SampleJob;

namespace {

/// A cube all red, or white.
JobBody cube(const OpenedJob& job, double edge_mm, bool white = false) {
    const SolidMesh mesh = shapes::box(Vector3d::Zero(), Vector3d::Constant(edge_mm));
    std::vector<Vector3f> rgb;
    if (!white) rgb.assign(mesh.triangles.size(), Vector3f(1, 0, 0));
    return body_of(mesh, job.printer.sliced_pitch_mm(), rgb);
}

LoopPlan plan_of(SampleJob& sample, double edge_mm = 5, bool all_white = false) {
    const OpenedJob job = sample.opened();
    return plan_loop(job, cube(job, edge_mm), all_white);
}

constexpr double cell_mm = 0.085, area_mm2 = 150;

}  // namespace

TEST_CASE("A loop is wanted where it has something to choose and nobody says no") {
    SampleJob automatic, none("0"), three("3");
    CHECK(plan_of(automatic).wanted);
    CHECK(plan_of(automatic).iterations == -1);
    CHECK(plan_of(three).iterations == 3);
    CHECK_FALSE(plan_of(none).wanted);
    CHECK(plan_of(none).why_not.empty());
    // White all over: not of its own accord, but where it is asked for.
    CHECK_FALSE(plan_of(automatic, 5, true).wanted);
    CHECK_THAT(plan_of(automatic, 5, true).why_not, Contains("white all over"));
    CHECK(plan_of(three, 5, true).wanted);

    OpenedJob job = automatic.opened();
    JobBody body = cube(job, 5);
    job.run.loop_done = true;
    CHECK_FALSE(plan_loop(job, body, false).wanted);
    job.run.goes_on = true;  // what was saved is looked at, done or not
    CHECK(plan_loop(job, body, false).wanted);
    job.resins.set.resins.resize(1);
    CHECK_FALSE(plan_loop(job, body, false).wanted);
    CHECK_THAT(plan_loop(job, body, false).why_not, Contains("one resin alone"));
    OpenedJob other = automatic.opened();
    other.resins.set.resins.resize(2);
    CHECK(nothing_to_rearrange(body, other.resins).empty());
    body.surface = SurfaceIndex(VisibleSurface());
    CHECK_THAT(nothing_to_rearrange(body, other.resins), Contains("no coloured surface"));
}

TEST_CASE("Bodies go downhill where contrast counts, pictures always, as far as they are small enough") {
    SampleJob sample;
    const auto descends = [&](double edge_mm, bool picture, halftone::Intent intent, LoopMethod method) {
        OpenedJob job = sample.opened();
        job.options.loop.intent = intent;
        job.options.loop.method = method;
        JobBody body = cube(job, edge_mm);
        body.is_picture = picture;
        return plan_loop(job, body, false).descent;
    };
    using halftone::Intent;
    // Cubes of just below and above the area.
    const double edge_mm = std::sqrt(100 * descent_cm2 / 6);
    CHECK(descends(0.99 * edge_mm, true, Intent::relative, LoopMethod::automatic));
    CHECK_FALSE(descends(1.01 * edge_mm, true, Intent::relative, LoopMethod::automatic));
    CHECK(descends(5, false, Intent::contrast, LoopMethod::automatic));
    CHECK_FALSE(descends(5, false, Intent::relative, LoopMethod::automatic));
    CHECK(descends(1.01 * edge_mm, false, Intent::relative, LoopMethod::descent));
    CHECK_FALSE(descends(5, true, Intent::contrast, LoopMethod::feedback));
}

TEST_CASE("A loop that surely finds no room says so, unless it is asked to try") {
    SampleJob sample;
    const auto said = [&](std::uint64_t allowed, std::optional<int> iterations = {}, bool goes_on = false) {
        OpenedJob job = sample.opened();
        job.options.prediction.memory_bytes = allowed;
        job.options.loop.iterations = iterations;
        job.run.goes_on = goes_on;
        const LoopPlan plan = plan_loop(job, cube(job, 40), false);
        CHECK(plan.wanted);
        return plan.does_not_fit;
    };
    CHECK_THAT(said(100u << 20), Contains("96 cm2") && Contains("100 MiB are allowed") && Contains("--memory"));
    CHECK(said(0).empty());  // no limit
    CHECK(said(std::uint64_t{64} << 30).empty());
    CHECK(said(100u << 20, 2).empty());
    CHECK(said(100u << 20, {}, true).empty());
}

TEST_CASE("What a loop takes goes with its cells and iterations") {
    LoopPlan plan{.wanted = true, .iterations = 2, .descent = false, .why_not = "", .does_not_fit = ""};
    const auto cost = [&](double area, double cell, std::uint64_t allowed = 0) {
        return expected_cost(plan, area, cell, allowed);
    };
    CHECK(cost(2 * area_mm2, cell_mm).cpu_seconds == Approx(2 * cost(area_mm2, cell_mm).cpu_seconds));
    CHECK(cost(area_mm2, cell_mm / 2).cpu_seconds == Approx(4 * cost(area_mm2, cell_mm).cpu_seconds));
    CHECK(cost(area_mm2, cell_mm).iterations == 2);
    const auto seconds = [&](int iterations, bool descent) {
        plan.iterations = iterations, plan.descent = descent;
        return cost(area_mm2, cell_mm).cpu_seconds;
    };
    // A step of feedback takes as long as the one before, one of the descent longer.
    const double none = seconds(0, false), step = seconds(1, false) - none;
    CHECK((none > 0 && step > 0));
    CHECK(seconds(10, false) - none == Approx(10 * step));
    CHECK(seconds(halftone::feedback_iterations, true) == Approx(seconds(halftone::feedback_iterations, false)));
    const double first_down =
        seconds(halftone::feedback_iterations + 1, true) - seconds(halftone::feedback_iterations, true);
    CHECK(first_down > step);
    CHECK(seconds(halftone::feedback_iterations + 4, true) - seconds(halftone::feedback_iterations, true) ==
          Approx(4 * first_down));
    // Without a limit of their own.
    plan.iterations = -1, plan.descent = true;
    CHECK(cost(area_mm2, cell_mm).iterations == halftone::most_iterations);
    plan.patient = true;
    CHECK(cost(area_mm2, cell_mm).iterations == halftone::patient_iterations);
    plan.descent = false;
    CHECK(cost(area_mm2, cell_mm).iterations < halftone::most_iterations);
    CHECK(cost(area_mm2, cell_mm).iterations > 1);
}

TEST_CASE("A loop keeps to what it is allowed, on disk and longer where that is little") {
    const LoopPlan plan{.wanted = true, .iterations = 4, .descent = true, .why_not = "", .does_not_fit = ""};
    constexpr std::uint64_t plenty = std::uint64_t{1} << 36, little = 150'000'000;
    const double large_mm2 = 100 * area_mm2;
    const LoopCost free = expected_cost(plan, large_mm2, cell_mm, 0),
                   wide = expected_cost(plan, large_mm2, cell_mm, plenty),
                   narrow = expected_cost(plan, large_mm2, cell_mm, little);
    CHECK((free.most_bytes == 0 && free.disk_bytes == 0));
    CHECK((wide.most_bytes == double(plenty) && wide.disk_bytes == 0));
    CHECK(wide.cpu_seconds == free.cpu_seconds);
    CHECK(narrow.most_bytes > double(little));  // what it takes at the least
    CHECK(expected_cost(plan, large_mm2 / 2, cell_mm, little).most_bytes < narrow.most_bytes);
    CHECK(expected_cost(plan, 1, cell_mm, little).most_bytes == double(little));
    CHECK(narrow.cpu_seconds > free.cpu_seconds);
    CHECK(narrow.cpu_seconds < 1.5 * free.cpu_seconds);
    CHECK(expected_cost(plan, 2 * large_mm2, cell_mm, little).disk_bytes == Approx(2 * narrow.disk_bytes));
    CHECK(narrow.disk_bytes > 0);
}

TEST_CASE("Predictions have what the loop's own state leaves, and a third at the least") {
    constexpr std::uint64_t allowed = 3'000'000'000;
    const std::uint64_t few = bytes_for_predictions(allowed, 100'000), more = bytes_for_predictions(allowed, 200'000);
    CHECK(few < allowed);
    CHECK(allowed - few > 100'000'000);  // the program alone
    CHECK(more < few);
    CHECK(bytes_for_predictions(allowed, 300'000) + few == Approx(2.0 * double(more)));
    CHECK(bytes_for_predictions(allowed, 100'000'000) == allowed / 3);
    CHECK(bytes_for_predictions(0, 100'000) == 0);
}

TEST_CASE("White is printed all white where all is white and the core is") {
    SampleJob sample;
    OpenedJob job = sample.opened();
    const auto all_white = [&](bool white) {
        const JobBody body = cube(job, 3, white);
        return prints_all_white(SurfaceColour(body.model.mesh, 0.1), job.resins);
    };
    CHECK_FALSE(all_white(false));
    REQUIRE(job.resins.set.resins[std::size_t(job.resins.core)].role == "W");
    CHECK(all_white(true));
    job.resins.core = job.resins.set.find("K");
    CHECK_FALSE(all_white(true));
}
