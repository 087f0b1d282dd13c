// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verdict of predictions whose every figure is laid down by hand: its figures, its sentences, what limits a cell.
#include "slicer/colour/verdict.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "judged_sheet.h"
#include "slicer/colour/viewer_report.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using enum halftone::RegionKind;
using Catch::Matchers::Contains, Catch::Matchers::EndsWith, Catch::Matchers::StartsWith;

namespace {

const Eigen::Vector3f red = of_codes(170, 60, 60), blue = of_codes(60, 90, 140), grey = of_codes(110, 110, 110);

void put_off(JudgedSheet& sheet, const CellBox& box, double off) {
    for (const std::uint32_t i : JudgedSheet::cells_of(box)) sheet.p.seen.difference[i] = off;
}

/// Nothing below a height of 1.2 mm left of a column.
void hollow(JudgedSheet& sheet, int column) {
    sheet.p.volume = optics::make_resin_volume(
        {JudgedSheet::columns, JudgedSheet::rows, 20}, {0.1, 0.1, 0.1},
        [column](int x, int, int z) { return x < column && z < 12 ? optics::air : optics::Material{1}; });
}

double reach_of(const Eigen::Vector3f& rgb) { return five_resins().separation.gamut_distance(rgb); }

}  // namespace

TEST_CASE("What limits a cell is the gamut where that is half of it, then a wall thinner than two shells, then light") {
    JudgedSheet sheet;
    hollow(sheet, 30);
    const std::uint32_t thin = JudgedSheet::at(10, 30), thick = JudgedSheet::at(60, 30);
    const Eigen::Vector3f green = of_codes(0, 255, 0);
    sheet.p.target[thin] = green;
    sheet.p.seen.difference[thin] = 2 * reach_of(green) - 0.01;
    CHECK(loss_of_cell(sheet.p, five_resins(), thin, 2).cause == LossCause::gamut);
    CHECK(loss_of_cell(sheet.p, five_resins(), thin, 2).wall_mm == 2);
    sheet.p.seen.difference[thin] = 2 * reach_of(green) + 0.01;
    const CellLoss of_wall = loss_of_cell(sheet.p, five_resins(), thin, 2);
    CHECK(of_wall.cause == LossCause::thin_wall);
    CHECK(of_wall.wall_mm == Approx(0.8).margin(0.051));
    CHECK(loss_of_cell(sheet.p, five_resins(), thin, 0.7).cause == LossCause::neighbours);
    sheet.p.seen.difference[thick] = 6;
    const CellLoss of_block = loss_of_cell(sheet.p, five_resins(), thick, 1.9);
    CHECK(of_block.cause == LossCause::neighbours);
    CHECK(of_block.wall_mm == 1.9);
}

TEST_CASE("A verdict's figures are means and shares by what is seen") {
    JudgedSheet sheet;
    sheet.becomes_body();
    hollow(sheet, 24);
    put_off(sheet, {0, 0, 24, 60}, 6), put_off(sheet, {24, 0, 32, 60}, 4), put_off(sheet, {32, 0, 80, 60}, 0.7);
    const io::ReportVerdict verdict = sheet.verdict();
    CHECK(verdict.level == io::VerdictLevel::fair);
    const double mean = 0.3 * 6 + 0.1 * 4 + 0.6 * 0.7;
    CHECK(verdict.seen_mean.value_or(0) == Approx(mean));
    CHECK(verdict.seen_p95 == 6.0);
    CHECK(verdict.wrong_share == Approx(0.3));
    CHECK(verdict.off_share == Approx(0.4));
    const double reach = std::min(0.7, reach_of(of_codes(150, 150, 150)));
    CHECK(verdict.reach_mean.value_or(9) == Approx(reach));
    CHECK(verdict.viewing_distance_mm == 300);
    CHECK(verdict.good_up_to == 2.5);
    CHECK(verdict.bad_above == 5);
    CHECK_FALSE(verdict.paper.has_value());
    double all = 0;
    for (const auto& [edge, share] : verdict.seen_histogram) {
        all += share;
        const double wanted = edge == 0.5 ? 0.6 : edge == 4 ? 0.1 : edge == 5 ? 0.3 : 0;
        CHECK(share == Approx(wanted).margin(1e-5));
    }
    CHECK(all == Approx(1));
    CHECK(verdict.seen_histogram.size() == 13);
    // What is off by more than "good", by its cause.
    REQUIRE(verdict.causes.size() == 2);
    CHECK(verdict.causes[0].name == "thin walls");
    CHECK(verdict.causes[0].share == Approx(1.8 / 2.2));
    CHECK(verdict.causes[1].name == "light between neighbouring colours and at edges");
    CHECK(verdict.causes[1].share == Approx(0.4 / 2.2));
    CHECK(verdict.why == "Mostly because light passes through thin walls (0.8 mm).");
    CHECK(verdict.headline == "On the whole fair, 2.6: much as asked, with differences that are seen");
    CHECK_THAT(verdict.sentence,
               StartsWith("On the whole fair, 2.6: much as asked, with differences that are seen (CIEDE2000 as seen "
                          "from 300 mm: up to 2.5 is good, above 5 bad; "));
    CHECK_THAT(verdict.sentence, Contains(" of it no mixture of these resins could avoid). Worst: "));
    // Thin walls are a row of their own.
    CHECK(JudgedSheet::row({verdict.regions, {}, {}}, "thin walls").area_mm2 == Approx(14.4));
    CHECK(verdict.but ==
          "Worst: thin walls (upper left front, seen from above) let light pass, 6 off on average: they are 0.8 mm "
          "thick.");
    CHECK(verdict.but_mm[2] == 2);
    CHECK(verdict.but_normal == std::array<double, 3>{0, 0, 1});
    REQUIRE_FALSE(verdict.advice.empty());
    CHECK_THAT(verdict.sentence, EndsWith(" (0.8 mm). Try: " + verdict.advice.front().text + "."));
    // Nearly all of it.
    put_off(sheet, {24, 0, 32, 60}, 0.7);
    CHECK_THAT(sheet.verdict().why, StartsWith("Nearly all of it because light passes through thin walls"));
}

TEST_CASE("Of a good print neither causes nor advice are told, and its worst thing begins with But") {
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, red, blue, 6.2);
    put_off(sheet, {6, 40, 26, 55}, 6.2);
    const io::ReportVerdict verdict = sheet.verdict();
    CHECK(verdict.level == io::VerdictLevel::good);
    CHECK(verdict.causes.empty());
    CHECK(verdict.advice.empty());
    CHECK(verdict.why.empty());
    CHECK(verdict.headline == "On the whole good, 0.4");
    CHECK(verdict.but == "But red (upper left) is printed as blue (60, 90, 140), 6 off.");
    CHECK_THAT(verdict.sentence, EndsWith(" is printed as blue (60, 90, 140), 6 off."));
    // In several places, of a body with the side that it is seen from.
    sheet.add(solid, {66, 10, 70, 30}, red, blue, 6.2);
    sheet.becomes_body();
    CHECK(sheet.verdict().but ==
          "But red (2 places, the largest upper left back, seen from above) is printed as blue (60, 90, 140), 6 off.");
    // Where all is well nothing is worst.
    sheet.p.seen.looks[0].difference = sheet.p.seen.looks[1].difference = 1;
    put_off(sheet, {0, 0, 80, 60}, 0);
    CHECK(sheet.verdict().but.empty());
}

TEST_CASE("Flecks are the worst thing of a print that is good, or where they spoil it") {
    JudgedSheet sheet;
    sheet.add(solid, {10, 10, 50, 50}, grey);
    const auto fleck = [&](float by) {
        for (const std::uint32_t i : sheet.p.seen.regions[0].cells)
            sheet.p.seen.print[i] = grey * (i % 3 == 1 ? 1 + by : 1 - by / 2);
    };
    fleck(0.06f);
    const double unevenness = sheet.row("grey").unevenness.value_or(0);
    REQUIRE((unevenness > 0.8 && unevenness < 1.8));
    CHECK_THAT(sheet.verdict().but, StartsWith("But grey (middle) is not even: flecked by "));
    put_off(sheet, {0, 0, 80, 60}, 3);
    CHECK(sheet.verdict().level == io::VerdictLevel::fair);
    CHECK(sheet.verdict().but.empty());
    fleck(0.3f);
    CHECK_THAT(sheet.verdict().but, StartsWith("Worst: grey (middle) is not even: flecked by "));
    CHECK(sheet.verdict().wrong_share == Approx(1600 / 4800.0));
}

TEST_CASE("A page's type and detail are named by what they are, and by their colour where they have one") {
    JudgedSheet sheet;
    sheet.add(solid, {0, 0, 80, 28}, grey);
    for (const std::uint32_t i : JudgedSheet::cells_of({30, 44, 42, 50})) sheet.p.seen.fine[i] = {0.2f, 0.4f};
    CHECK_THAT(sheet.verdict().but, StartsWith("But fine detail (upper) keeps 0.40 of its contrast"));
    for (halftone::FineContrast& fine : sheet.p.seen.fine) fine = {};
    const Eigen::Vector3f white = of_codes(255, 255, 255), black = of_codes(0, 0, 0);
    sheet.paint({10, 32, 60, 58}, white, white);
    sheet.add(strokes, {40, 42, 50, 50}, black, Eigen::Vector3f::Constant(0.6f), 3);
    CHECK_THAT(sheet.verdict().but, StartsWith("But type and lines, black (upper) are hard to read: "));
}

TEST_CASE("The light that eyes take for white is told where it is clearly less than was asked for") {
    JudgedSheet sheet;
    sheet.p.seen.paper = 0.971f;
    CHECK_FALSE(sheet.verdict().paper.has_value());
    CHECK_THAT(sheet.verdict().sentence, Contains("as seen from 300 mm: up to"));
    sheet.p.seen.paper = 0.875f;
    CHECK(sheet.verdict().paper.value_or(0) == Approx(0.875));
    CHECK_THAT(sheet.verdict().sentence, Contains("as seen from 300 mm by eyes that take its white, 0.88 of the light "
                                                  "that was asked for, for white: up to"));
}

TEST_CASE("Sides are told with what is seen of them, and said where the best and the worst differ") {
    JudgedSheet sheet;
    for (const std::uint32_t i : JudgedSheet::cells_of({0, 0, 40, 20})) {  // the left of the front
        optics::SurfaceCell& cell = sheet.p.predicted.surface.cells[i];
        cell.centre_mm = {cell.centre_mm[0], 0, cell.centre_mm[1]}, cell.normal = {0, -1, 0};
    }
    sheet.becomes_body();
    put_off(sheet, {0, 0, 40, 20}, 7);
    io::ReportVerdict verdict = sheet.verdict();
    std::array<double, all_sides> seen{}, off{};
    double all = 0;
    for (std::size_t i = 0; i < 4800; ++i)
        for (std::size_t side = 0; side < all_sides; ++side) {
            const double part = 0.01 * sheet.p.sides.from(static_cast<Side>(side), i);
            seen[side] += part, off[side] += part * sheet.p.seen.difference[i], all += part;
        }
    REQUIRE(verdict.sides.size() == 6);  // the underside is 3 % of it: what looks to the front is seen from below, too
    for (std::size_t side = 0; side < all_sides; ++side) {
        CHECK(verdict.sides[side].name == name_of(static_cast<Side>(side)));
        CHECK(verdict.sides[side].share == Approx(seen[side] / all).epsilon(1e-4));
        CHECK(verdict.sides[side].mean == Approx(off[side] / seen[side]).epsilon(1e-4));
    }
    CHECK_THAT(verdict.sentence, Contains(". From the back 0.0, from below 7.0."));
    put_off(sheet, {0, 0, 40, 20}, 2.4);
    CHECK_THAT(sheet.verdict().sentence, !Contains("from below"));
    // A picture has one side, and says nothing of it.
    sheet.stays_picture();
    CHECK(sheet.verdict().sides.empty());
}

TEST_CASE("Where all of it is white, or nothing was predicted, that is said, and lost colours whatever is known") {
    JudgedSheet sheet;
    const std::optional<JobPrediction> none;
    io::ReportGamut gamut{.mapped_share = 0, .mean_de2000 = 0.4};
    std::string why_not;
    const auto verdict = [&](bool all_white) {
        return judge({sheet.job, sheet.body, five_resins(), none, why_not, gamut, sheet.loop, all_white});
    };
    CHECK(verdict(true).level == io::VerdictLevel::good);
    CHECK(verdict(true).headline == "It will look as asked: white everywhere");
    CHECK(verdict(true).sentence ==
          "It will look as asked: white everywhere. All of it is white resin, so that there "
          "was nothing to rearrange and nothing to predict.");
    CHECK(verdict(false).level == io::VerdictLevel::unknown);
    CHECK(verdict(false).headline == "Colours in reach: 100 %");
    CHECK(verdict(false).sentence ==
          "Colours in reach: 100 %. The loaded resins show nearly all of its colours, on a thick body. How it will "
          "look was not predicted: it was not asked for (--predict).");
    gamut = {.mapped_share = 0.126, .mean_de2000 = 1.26}, why_not = "It takes too much memory.";
    CHECK(verdict(false).headline == "Colours in reach: 87 %");
    CHECK(verdict(false).why ==
          "The loaded resins cannot show 13 % of the surface, whose colours are moved: by 1.3 CIEDE2000 on average "
          "over all of it, on a thick body. How it will look was not predicted: it takes too much memory.");
    sheet.body.model.lost_colour = "The picture skin.png is missing.";
    CHECK(verdict(true).level == io::VerdictLevel::bad);
    CHECK(verdict(true).sentence ==
          "It will not look as asked. The picture skin.png is missing. What is left is white everywhere.");
    CHECK(verdict(true).but == sheet.body.model.lost_colour);
    CHECK_THAT(verdict(false).sentence,
               StartsWith("It will not look as asked. The picture skin.png is missing. By the colours that are left "
                          "colours in reach: 87 %. "));
}

TEST_CASE("The worst places are those that are seen to be most off, a twelfth of the body apart, ten at most") {
    JudgedSheet sheet;
    sheet.becomes_body();
    io::TexturedMesh painted;
    painted.materials.resize(1), painted.material_of_triangle = {0};
    painted.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, painted.triangles = {{0, 1, 2}};
    const auto places = [&] {
        const std::optional<JobPrediction> prediction(sheet.p);
        const SurfaceColour colour(painted, 0.1);
        return worst_places({sheet.job, sheet.body, five_resins(), colour, prediction}, *prediction);
    };
    CHECK(places().empty());
    hollow(sheet, 30);
    const auto off = [&](int x, int y, double by) { sheet.p.seen.difference[JudgedSheet::at(x, y)] = by; };
    off(10, 10, 9), off(14, 10, 8), off(10, 16, 7.5), off(60, 40, 2.6), off(40, 20, 2.5);
    sheet.p.seen.target[JudgedSheet::at(10, 10)] = red, sheet.p.seen.print[JudgedSheet::at(10, 10)] = blue;
    auto found = places();
    // 8 mm / 12 is 0.67 mm: those 0.4 and 0.6 mm away are of the same place, and what is good is none.
    REQUIRE(found.size() == 2);
    CHECK(found[0].at_mm[0] == Approx(1.05));
    CHECK(found[0].at_mm[1] == Approx(1.05));
    CHECK(found[0].at_mm[2] == 2);
    CHECK(found[0].normal == std::array<double, 3>{0, 0, 1});
    CHECK(found[0].seen == 9);
    CHECK(found[0].target == io::Rgb{170, 60, 60});
    CHECK(found[0].print == io::Rgb{60, 90, 140});
    CHECK_THAT(found[0].cause, StartsWith("thin walls, 0.8"));
    CHECK(found[0].words == "upper left front");
    CHECK(found[1].seen == 2.6);
    CHECK(found[1].cause == "light between neighbouring colours and at edges");
    off(10, 17, 7.5);  // 0.7 mm
    CHECK(places().size() == 3);
    // What is hardly seen comes last.
    sheet.p.predicted.surface.cells[JudgedSheet::at(10, 10)].normal = {0, 0, -1};
    sheet.p.predicted.surface.cells[JudgedSheet::at(10, 10)].centre_mm[2] = 0;
    sheet.look_from_outside();
    found = places();
    CHECK(found.front().seen == 8);
    CHECK(found.back().seen == 9);
    for (int x = 0; x < 80; x += 8)
        for (int y = 0; y < 60; y += 8) off(x, y, 3 + x / 100.0);
    CHECK(places().size() == 10);
}
