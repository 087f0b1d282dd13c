// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is advised where a print is not as asked, and what each is said to come to, of means that are put down by hand.
#include "slicer/colour/tried_advice.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "halftone/loop/appearance_loop.h"
#include "judged_sheet.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains, Catch::Matchers::EndsWith, Catch::Matchers::StartsWith;

namespace {

/// A body of 8 x 6 x 2 mm, black on its right half: at an edge light spreads over a fixed length, e = 1.
struct Advised {
    Advised() {
        sheet.becomes_body();
        sheet.paint({40, 0, 80, 60}, of_codes(0, 0, 0), of_codes(0, 0, 0));
        sheet.job.options.prediction.automatic = false;
    }
    [[nodiscard]] std::vector<io::ReportAdvice> all() const {
        return tried_advice({sheet.job, sheet.body, sheet.p, sheet.seen, sheet.loop, mean, page, whole});
    }
    /// That begins so; one without text where there is none.
    [[nodiscard]] io::ReportAdvice one(const std::string& begin) const {
        io::ReportAdvice found;
        for (const io::ReportAdvice& advice : all())
            if (advice.text.starts_with(begin)) found = advice;
        return found;
    }
    [[nodiscard]] io::ReportAdvice rearranged() const { return one("let the resins"); }
    [[nodiscard]] io::ReportAdvice larger() const { return one("print it larger"); }
    [[nodiscard]] io::ReportAdvice thicker() const {
        const io::ReportAdvice walls = one("make walls");
        return walls.text.empty() ? one("print open sheets") : walls;
    }
    void loop_of(const std::vector<double>& means, int iterations) {
        JobLoop& loop = sheet.loop.emplace();
        for (const double of : means) loop.result.state.steps.emplace_back().seen.mean = of;
        loop.result.why_stopped = halftone::all_iterations_made;
        sheet.job.options.loop.iterations = iterations;
    }
    JudgedSheet sheet;
    MeanParts mean;
    PageVerdict page;
    WholeVerdict whole;
};

}  // namespace

TEST_CASE("The loop leaves two thirds of what resins reach at the most, and walls of a few voxels as they are") {
    Advised of;
    of.mean = {.reach = 1, .flat = 1, .neighbours = 3};
    io::ReportAdvice advice = of.rearranged();
    CHECK(advice.text == "let the resins be rearranged until that gains no more (--iterations auto): then 3.6 or less");
    CHECK(advice.options == "--iterations auto");
    CHECK(advice.figure == "seen_de2000");
    CHECK(advice.now == 5);
    CHECK(advice.then == Approx(1 + 0.65 * 4));
    of.mean = {.thin = 3, .neighbours = 2, .wall_mm = 0.24, .thick_walls = 3};
    CHECK(of.rearranged().then == Approx(3 + 0.65 * 2));
    of.mean.wall_mm = 0.25;
    CHECK(of.rearranged().then == Approx(0.65 * 5));
    // What brings less than a tenth is no advice, nor is there anything to rearrange of one resin.
    of.mean = {.reach = 4, .neighbours = 1.5};
    CHECK(of.rearranged().text.empty());
    of.mean = {.reach = 3.9, .neighbours = 1.6};
    CHECK_FALSE(of.rearranged().text.empty());
    of.sheet.job.resins.set = of.sheet.job.resins.set.subset(std::vector<std::string>{"K", "W"});
    CHECK_FALSE(of.rearranged().text.empty());
    of.sheet.job.resins.set = of.sheet.job.resins.set.subset(std::vector<std::string>{"W"});
    CHECK(of.rearranged().text.empty());
}

TEST_CASE("A loop that was cut short goes on by its last gains, and another size would be cut short elsewhere") {
    Advised of;
    of.mean = {.neighbours = 5};
    of.loop_of({8, 7, 6}, 3);
    // Each gain is 0.7 of the one before, five times more; at the least 0.65 of where it began.
    CHECK(of.rearranged().then == Approx(5 * 5.2 / 6));
    CHECK_THAT(of.rearranged().text, EndsWith("then 4.3 or less"));
    CHECK(of.larger().text.empty());
    of.loop_of({7, 6.8, 6.2, 5.6}, 7);
    CHECK(of.rearranged().text.empty());  // 0.42 more of 5.6
    of.loop_of({7, 6.8, 6.2, 5.6}, 6);
    CHECK(of.rearranged().then == Approx(5 * (5.6 - 0.6 * (0.7 + 0.49)) / 5.6));
    // Iterates by descent have no part in it.
    of.loop_of({8, 7, 6, 1}, 3);
    of.sheet.loop->result.state.steps.back().method = halftone::LoopMethod::descent;
    CHECK(of.rearranged().then == Approx(5 * 5.2 / 6));
    of.loop_of({0, 0}, 3);
    CHECK(of.rearranged().text.empty());
    // One that stopped by itself has nothing to go on for.
    of.loop_of({8, 7, 6}, 3);
    of.sheet.loop->result.why_stopped = "it stopped gaining";
    CHECK(of.rearranged().text.empty());
    CHECK_FALSE(of.larger().text.empty());
    of.loop_of({8, 7, 6}, halftone::most_iterations);
    CHECK(of.rearranged().text.empty());
    of.loop_of({8, 7, 6}, 3);
    of.sheet.job.options.loop.iterations.reset();
    CHECK(of.rearranged().text.empty());
}

TEST_CASE("Thicker walls become as thick ones are, and where none is known of a few voxels a third is left at most") {
    Advised of;
    of.mean = {.thin = 3, .neighbours = 2, .wall_mm = 0.5, .thick_walls = 0.4};
    io::ReportAdvice advice = of.thicker();
    CHECK(advice.text == "make walls of 0.5 mm at least 2 mm thick in a mesh editor: then about 2.4");
    CHECK(advice.options.empty());
    CHECK((advice.now == 5 && advice.then == Approx(2.4)));
    of.sheet.stays_picture();
    advice = of.thicker();
    CHECK(advice.text == "make walls of 0.5 mm at least 2 mm thick (--thickness 2mm): then about 2.4");
    CHECK(advice.options == "--thickness 2mm");
    of.sheet.job.options.colour.depth_mm = 0.75;
    CHECK(of.thicker().options == "--thickness 1.5mm");
    // As much is in thick walls as in thin ones: nothing is known.
    of.mean.thick_walls = 3;
    CHECK(of.thicker().text.empty());
    of.mean.wall_mm = 0.2;
    CHECK(of.thicker().then == Approx(2 + 0.35 * 3));
    CHECK_THAT(of.thicker().text, EndsWith(fmt::format("then {:.1f} or less", of.thicker().then)));
    of.mean = {.thin = 0.5, .neighbours = 4.5, .wall_mm = 0.5, .thick_walls = 0.1};
    CHECK(of.thicker().text.empty());
}

TEST_CASE("Open sheets are given a thickness, where they are a good part of the thin walls") {
    Advised of;
    of.mean = {.thin = 3, .neighbours = 2, .wall_mm = 0.1, .thick_walls = 3, .thin_mm2 = 20};
    // Two triangles of 6 mm2, back to back, and one that has no back.
    SolidMesh sheets;
    sheets.positions_mm = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 3, 9}};
    sheets.triangles = {{0, 1, 2}, {2, 1, 0}, {1, 2, 3}};
    of.sheet.body.solid = SolidIndex(sheets);
    io::ReportAdvice advice = of.thicker();  // 12 of 20
    CHECK(advice.text ==
          fmt::format("print open sheets 2 mm thick (--sheet-thickness 2mm): then {:.1f} or less", advice.then));
    CHECK(advice.then == Approx(2 + 0.35 * 3));
    CHECK(advice.options == "--sheet-thickness 2mm");
    of.mean.thin_mm2 = 24;
    CHECK(of.thicker().then == Approx(2 + 0.35 * 3));
    // Of less than half those that stay are as they were.
    of.mean.thin_mm2 = 30;
    CHECK(of.thicker().then == Approx(2 + (1 - 0.4 * 0.65) * 3));
    of.mean.thick_walls = 1;
    CHECK(of.thicker().then == Approx(2 + (1 - 0.4 * 0.65) * 3));
    of.mean.thinnest = 1.8;  // of what is lost 0.6 is lost in them
    CHECK(of.thicker().then == Approx(2 + (1 - 0.6 * 0.65) * 3));
    // Less than a quarter is not worth a word: then it is walls.
    of.mean.thinnest = 0, of.mean.thin_mm2 = 49;
    CHECK_THAT(of.thicker().text, StartsWith("make walls of 0.1 mm"));
    of.mean.thin_mm2 = 48, of.mean.neighbours = 1;
    CHECK_THAT(of.thicker().text, StartsWith("print open sheets"));
    // A size makes them no thicker.
    of.mean = {.thin = 4, .neighbours = 1, .wall_mm = 0.1, .thick_walls = 4, .thin_mm2 = 12};
    CHECK(of.larger().text.empty());
    of.mean.thin_mm2 = 48;
    CHECK_FALSE(of.larger().text.empty());
}

TEST_CASE("As large is advised as makes the middle of what it comes to good, and a third of it is told either way") {
    Advised of;
    of.mean = {.neighbours = 4.2};
    io::ReportAdvice advice = of.larger();
    // (4.2 / k + 4.2 k^(-1/4)) / 2 is 2.5 at k = 2.64, from 1.25 on in steps of a tenth 2.68: 21.4 mm.
    CHECK(advice.options == "--size 22mm");
    CHECK(advice.figure == "seen_de2000");
    CHECK(advice.now == 4.2);
    const double k = 22.0 / 8;
    CHECK(advice.then == Approx(4.2 / k).epsilon(0.02));
    CHECK(advice.text == fmt::format("print it larger (--size 22mm): then {:.1f} to 3.3", advice.then));
    // Nothing is good at four times, and twice as large is said.
    of.mean = {.neighbours = 9};
    CHECK(of.larger().options == "--size 16mm");
    CHECK(of.larger().then == Approx(4.5).epsilon(0.03));
    CHECK_THAT(of.larger().text, EndsWith(" to 7.6"));  // 9 / 2^(1/4)
    // What is clearly off shrinks with the size, too, but not what is out of reach.
    of.mean = {.neighbours = 2.6};
    of.whole.wrong_share = 0.3;
    CHECK(of.larger().options == "--size 26mm");  // 3.2 times: 0.09
    of.mean.reach_off = 0.11;
    CHECK(of.larger().options == "--size 16mm");
    of.mean.reach_off = 0, of.whole.wrong_share = 0;
    CHECK(of.larger().options == "--size 10mm");
    // A print that is good needs none.
    of.mean = {.neighbours = 2.5};
    CHECK(of.larger().text.empty());
    of.whole.wrong_share = 0.11;
    CHECK_FALSE(of.larger().text.empty());
    of.whole.wrong_share = 0.1;
    CHECK(of.larger().text.empty());
    // What does not grow smaller by a tenth is no advice: it is out of reach.
    of.whole.wrong_share = 0, of.mean = {.reach = 6, .neighbours = 0.6};
    CHECK(of.larger().text.empty());
}

TEST_CASE("No print is advised that the tray does not hold") {
    Advised of;
    of.mean = {.neighbours = 9};
    of.sheet.job.printer.tray_mm = {14, 390, 200};
    CHECK(of.larger().options == "--size 14mm");
    of.sheet.job.printer.tray_mm = {490, 9, 200};
    CHECK(of.larger().options == "--size 12mm");
    of.sheet.job.printer.tray_mm = {490, 390, 3};
    CHECK(of.larger().options == "--size 12mm");
    of.sheet.stays_picture();  // whose thickness is another option
    CHECK(of.larger().options == "--width 16mm");
    of.sheet.job.printer.tray_mm = {8, 390, 3};
    CHECK(of.larger().text.empty());
}

TEST_CASE("A size is said by the option that the user said it by") {
    Advised of;
    of.sheet.stays_picture();
    of.mean = {.neighbours = 9};
    const auto option = [&](double width_mm, double height_mm, double size_mm, double dpi) {
        PictureOptions& picture = of.sheet.job.options.picture;
        picture.width_mm = width_mm, picture.height_mm = height_mm, picture.size_mm = size_mm, picture.dpi = dpi;
        return of.larger().options;
    };
    CHECK(option(8, 0, 0, 0) == "--width 16mm");
    CHECK(option(0, 6, 0, 0) == "--height 12mm");
    CHECK(option(0, 0, 8, 0) == "--size 16mm");
    CHECK(option(0, 0, 0, 254) == "--width 16mm");
    CHECK(option(0, 0, 8, 254) == "--width 16mm");
    CHECK(option(0, 0, 0, 0) == "--width 16mm");
    of.sheet.body.placement.extent_mm = {6, 8.2, 2};
    CHECK(option(0, 0, 8.2, 0) == "--size 16.5mm");
    CHECK(option(0, 0, 0, 0) == "--width 12mm");
}

TEST_CASE("Type and codes that cannot be read are made as large as they are read from, and a tenth more for type") {
    Advised of;
    of.sheet.stays_picture();
    of.mean = {.neighbours = 2};
    of.page.type_times = 1.5, of.page.smallest_type_mm = 1;
    io::ReportAdvice advice = of.larger();
    CHECK(advice.text ==
          "print it larger (--width 13.5mm): then its smallest type is of 1.7 mm (5 pt), and nearly all "
          "of it can be read");
    CHECK(advice.figure == "type_mm");
    CHECK((advice.now == 1 && advice.then == Approx(13.5 / 8)));
    of.page.type_times = 1, of.page.module_mm = 0.25;
    advice = of.larger();
    CHECK(advice.text == "print it larger (--width 13mm): then its code has modules of 0.41 mm, which scanners read");
    CHECK(advice.options == "--width 13mm");
    CHECK(advice.figure == "module_mm");
    CHECK((advice.now == 0.25 && advice.then == Approx(0.25 * 13 / 8)));
    // Both, by what needs more.
    of.page.type_times = 2;
    CHECK(of.all().back().options == "--width 18mm");
    CHECK(of.all()[of.all().size() - 2].figure == "module_mm");
    CHECK(of.all().back().figure == "type_mm");
    // A tray that is too small for one holds the other.
    of.sheet.job.printer.tray_mm = {14, 390, 200};
    CHECK(of.all().back().figure == "module_mm");
    of.page.module_mm = 0.4, of.page.type_times = 1;
    CHECK(of.larger().text.empty());
    // Where colours need more than type does, the size is theirs.
    of.sheet.job.printer.tray_mm = {490, 390, 200};
    of.mean = {.neighbours = 4.2}, of.page.type_times = 1.5;
    CHECK(of.larger().options == "--width 22mm");
    CHECK(of.larger().figure == "type_mm");
}

TEST_CASE("A thickness that an option gives comes first where thin walls are most of it, and the size last") {
    Advised of;
    of.sheet.stays_picture();
    of.mean = {.thin = 4, .neighbours = 2, .wall_mm = 0.5, .thick_walls = 0.4};
    std::vector<io::ReportAdvice> all = of.all();
    REQUIRE(all.size() == 3);
    CHECK(all[0].options == "--thickness 2mm");
    CHECK(all[1].options == "--iterations auto");
    CHECK_THAT(all[2].text, StartsWith("print it larger"));
    of.mean = {.thin = 3, .neighbours = 3, .wall_mm = 0.5, .thick_walls = 0.4};
    CHECK(of.all()[0].options == "--iterations auto");
    of.sheet.becomes_body();  // in a mesh editor
    of.mean = {.thin = 4, .neighbours = 2, .wall_mm = 0.5, .thick_walls = 0.4};
    CHECK(of.all()[0].options == "--iterations auto");
}

TEST_CASE("Where nothing thick tells what walls would be like, the least is said as the best that there is") {
    Advised of;
    of.mean = {.thin = 4, .neighbours = 2, .wall_mm = 0.5, .thick_walls = 4};
    CHECK_THAT(of.larger().text, EndsWith(" at best"));
    of.mean.thick_walls = 3.9;
    CHECK_THAT(of.larger().text, !Contains("at best"));
    of.mean = {.thin = 0.5, .neighbours = 5.5, .wall_mm = 0.5, .thick_walls = 0.5};
    CHECK_THAT(of.larger().text, !Contains("at best"));
}

TEST_CASE("A larger print that would not be predicted by itself is advised with a prediction") {
    Advised of;
    of.mean = {.neighbours = 4.2};
    // From 10 cm2 on; the size is 2.75 times as large.
    const auto options = [&](double area_mm2) {
        VisibleSurface one;
        one.positions_mm = {{0, 0, 0}, {area_mm2, 0, 0}, {0, 2, 0}};
        one.triangles = {{0, 1, 2}}, one.source_triangle = {0}, one.source_uv.resize(1);
        of.sheet.body.surface = SurfaceIndex(std::move(one));
        return of.larger().options;
    };
    CHECK(options(133) == "--size 22mm");
    of.sheet.job.options.prediction.automatic = true;
    CHECK(options(132) == "--size 22mm");
    CHECK(options(133) == "--size 22mm --predict transport");
    of.loop_of({8, 7}, halftone::most_iterations);
    CHECK(options(133) == "--size 22mm");
}
