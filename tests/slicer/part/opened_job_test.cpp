// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/opened_job.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "base/error.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("An opened job knows how its bitmaps are coloured, where its layers lie and of what they are") {
    test::SampleJob sample("0", "none");
    sample.options.load = {"W", "K"};
    sample.options.resume = true;
    OpenedJob job = sample.opened();
    CHECK((job.run.goes_on && !job.run.loop_elsewhere && !job.run.loop_done));
    std::vector<io::Rgb> palette = job.palette();
    REQUIRE(palette.size() == 3);
    CHECK(palette[0] == job.printer.background_rgb);
    CHECK((palette[1] == job.resins.entries[0].rgb && palette[2] == job.resins.entries[1].rgb));
    VoxelGrid grid;
    grid.size = {30, 20, 50}, grid.origin_mm = {1, 2, 3};
    const io::StackDescription stack = job.describe(grid, {7, 40});
    CHECK((stack.layers == 34 && stack.first_layer == 7));
    CHECK(std::max(stack.size_px[0], stack.size_px[1]) == 30);
    CHECK(std::min(stack.size_px[0], stack.size_px[1]) == 20);
    CHECK(stack.origin_mm == std::array{1.0, 2.0, 3.0});
    CHECK((stack.resins.size() == 2 && stack.resins[1].role == "K"));
    CHECK(job.outputs().printer_folder);
    job.load({"C", "W"});
    CHECK((job.palette().size() == 3 && job.resins.entries[0].role == "C" && job.resins.core == 1));
    CHECK(job.options.load == std::vector<std::string>{"C", "W"});
    // What a run is, somebody else may decide.
    const OpenedJob decided = open_job(sample.options, [](const OpenedJob& opened, JobRun& run) {
        CHECK(&opened.run == &run);
        run.loop_done = true;
    });
    CHECK(decided.run.loop_done);
}

TEST_CASE("A mark by a resin alone has its colour in the shell, and one that is not loaded is refused") {
    test::SampleJob sample("0", "none");
    sample.options.load = {"W", "K"};
    OpenedJob job = sample.opened();
    MarkOptions mark;
    mark.said = "--mark text=A", mark.resin = "K";
    job.options.marks = {mark, mark};
    job.options.marks[1].resin = "W";
    job.load({"W", "K"});
    CHECK(job.options.marks[0].ink_rgb.maxCoeff() < 0.1f);
    CHECK(job.options.marks[1].ink_rgb.isApprox(Eigen::Vector3f::Ones(), 0.02f));
    job.options.marks[1].resin = "C";
    std::string said;
    try {
        job.load({"W", "K"});
    } catch (const InputError& error) {
        said = error.what();
    }
    CHECK(said == "--mark text=A: resin=C is not loaded; loaded are W, K (--load)");
}

TEST_CASE("What makes a body higher goes with what it is: a picture, a flat one, any other") {
    JobBody body;
    body.placement.extent_mm = {10, 5, 0.0009};
    CHECK(enough_layers(body) == "thicker (--sheet-thickness), for it is flat, or turn it (--rotate)");
    body.placement.extent_mm.z() = 0.0011;
    CHECK(enough_layers(body) == "larger (--size), or turn it (--rotate)");
    body.is_picture = true;
    CHECK(enough_layers(body) == "thicker (--thickness)");
}
