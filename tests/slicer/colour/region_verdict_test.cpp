// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is said of regions whose figures are laid down by hand.
#include "slicer/colour/region_verdict.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "judged_sheet.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using enum halftone::RegionKind;
using Catch::Matchers::EndsWith, Catch::Matchers::StartsWith;

namespace {

const Eigen::Vector3f red = of_codes(170, 60, 60), dark_red = of_codes(150, 40, 40), blue = of_codes(60, 90, 140),
                      grey = of_codes(110, 110, 110), white = of_codes(255, 255, 255), black = of_codes(0, 0, 0);

/// A grey ground over the lower half, so that the sheet is graphics.
void add_ground(JudgedSheet& sheet) { sheet.add(solid, {0, 0, 80, 28}, grey); }

}  // namespace

TEST_CASE("A region's row says what was asked for, what is printed, where it lies, how large it is and how far off") {
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, red, blue, 6.2);
    const io::ReportRegion row = sheet.row("red");
    CHECK(row.kind == "solid");
    CHECK(row.asked == "red (170, 60, 60)");
    CHECK(row.printed == "blue (60, 90, 140)");
    CHECK(row.asked_seen.empty());
    CHECK(row.area_mm2 == Approx(3));
    CHECK(row.de2000 == 6.2);
    CHECK(row.place_mm[0] == Approx(1.6).margin(0.06));
    CHECK(row.place_mm[1] == Approx(4.75).margin(0.01));
    CHECK(row.place_mm[2] == 2);
    CHECK(row.normal == std::array<double, 3>{0, 0, 1});
    CHECK(row.place == "upper left");
    CHECK(row.from.empty());
    CHECK(row.pieces == 1);
    CHECK(row.seen_share == Approx(1));
    CHECK_FALSE(row.good);
    CHECK(row.why == "is printed as blue (60, 90, 140), 6 off");
    CHECK(row.rim == 0.0);
    CHECK(row.unevenness.value_or(9) < 0.01);
    CHECK(row.contrast_asked == 0);
    CHECK_FALSE(row.type_mm.has_value());
}

TEST_CASE("A region is good up to the limit and no further, and words that are the same are told apart by numbers") {
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, red, dark_red, 5);
    CHECK(sheet.row("red").good);
    CHECK(sheet.row("red").why.empty());
    sheet.p.seen.looks[0].difference = 5.01;
    const io::ReportRegion row = sheet.row("red");
    CHECK_FALSE(row.good);
    CHECK(row.why == "is printed as darker red (150, 40, 40) for (170, 60, 60), 5 off");
    sheet.limits.bad = 5.1;
    CHECK(sheet.row("red").good);
}

TEST_CASE("A solid's rim is one above twice what is bad, and told with its colour where that is not good") {
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, red, dark_red, 2.5);
    sheet.p.seen.rims[0] = 10;
    CHECK(sheet.row("red").good);
    sheet.p.seen.rims[0] = 11.4;
    CHECK(sheet.row("red").why == "has a rim of another colour, 11 off in chroma");
    CHECK(sheet.row("red").rim == 11.4);
    sheet.p.seen.looks[0].difference = 2.6;
    CHECK(sheet.row("red").why ==
          "is printed as darker red (150, 40, 40) for (170, 60, 60), 3 off, and has a rim of another colour");
    sheet.p.seen.rims[0] = -12;  // less chroma is none
    CHECK(sheet.row("red").good);
    CHECK(sheet.row("red").rim == 0.0);
    // Paper has none.
    sheet.p.seen.rims[0] = 30, sheet.p.seen.regions[0].kind = paper;
    CHECK_FALSE(sheet.row("red").rim.has_value());
    CHECK(sheet.row("red").kind == "paper");
}

TEST_CASE("What no mixture of the resins is nearer to is said to be so") {
    const Eigen::Vector3f green = of_codes(0, 255, 0);
    const double reach = five_resins().separation.gamut_distance(green);
    REQUIRE(reach > 6);
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, green, of_codes(60, 160, 90), 2 * reach - 0.1);
    CHECK(sheet.row("green").out_of_reach);
    CHECK_THAT(sheet.row("green").why, EndsWith(" off: no mixture of the loaded resins is nearer"));
    sheet.p.seen.looks[0].difference = 2 * reach + 0.1;
    CHECK_FALSE(sheet.row("green").out_of_reach);
    CHECK_THAT(sheet.row("green").why, EndsWith(" off"));
}

TEST_CASE("What the eye makes of a small thing is told where it is clearly another colour than what was asked for") {
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, red, blue, 6);
    const Eigen::Vector3f mixed = of_codes(140, 90, 90);
    sheet.p.seen.looks[0].asked = lab_of(mixed);
    REQUIRE(optics::ciede2000(lab_of(red), lab_of(mixed)) > 5);
    CHECK(sheet.row("red").asked_seen == colour_word(mixed) + " (140, 90, 90)");
    // Words that are the same are told apart by what is seen of what was asked for.
    sheet.p.seen.looks[0].lab = lab_of(of_codes(120, 75, 75));
    REQUIRE(colour_word(mixed) == colour_word(of_codes(120, 75, 75)));
    CHECK(sheet.row("red").why ==
          "is printed as darker " + colour_word(mixed) + " (120, 75, 75) for (140, 90, 90), 6 off");
    sheet.limits.bad = 1 + optics::ciede2000(lab_of(red), lab_of(mixed));
    CHECK(sheet.row("red").asked_seen.empty());
}

TEST_CASE("Over the paper's level a tint is told as a tint, and not as white") {
    JudgedSheet sheet;
    sheet.add(solid, {6, 40, 26, 55}, of_codes(255, 240, 200), 1);
    sheet.p.seen.looks[0].lab = optics::lab_from_linear_srgb(Eigen::Vector3d(1.25, 1.25, 1.0));
    CHECK(sheet.row("solid").printed == colour_word({1, 1, 0.8f}) + " (255, 255, 231)");
}

TEST_CASE("Type on a page is judged by its contrast against what lies within half a millimetre") {
    JudgedSheet sheet;
    add_ground(sheet);
    // Black on white, six cells of it and then grey; it comes out as 0.2 on 0.6.
    sheet.paint({20, 30, 60, 60}, of_codes(90, 90, 90), black);
    sheet.paint({35, 37, 52, 55}, white, Eigen::Vector3f::Constant(0.6f));
    sheet.add(strokes, {40, 42, 47, 50}, Eigen::Vector3f::Constant(0.02f), Eigen::Vector3f::Constant(0.2f), 12);
    io::ReportRegion row = sheet.row("type and lines");
    CHECK(row.contrast_asked == Approx((1 - 0.02) / 1.02));
    CHECK(row.contrast == Approx(0.5).margin(1e-6));
    CHECK(row.good);
    CHECK_FALSE(row.de2000.has_value());
    CHECK_FALSE(row.unevenness.has_value());
    CHECK_FALSE(row.rim.has_value());
    for (const std::uint32_t i : sheet.p.seen.regions[1].cells) sheet.p.predicted.rgb[i].setConstant(0.22f);
    row = sheet.row("type and lines");
    CHECK_FALSE(row.good);
    CHECK(row.contrast == Approx(0.38 / 0.82));
    CHECK(row.why == "are hard to read: the contrast is 0.46, 0.96 was asked for and 0.5 is legible");
    // What comes out in another hue is another colour all the same.
    sheet.p.seen.looks[1].lab = Eigen::Vector3d(50, 60, 20);
    CHECK(sheet.row("type and lines").de2000 == 12.0);
    // Of a body it is a leg or a stripe.
    sheet.becomes_body();
    row = sheet.row("black");
    CHECK(row.kind == "solid");
    CHECK(row.contrast_asked == 0);
    CHECK(row.de2000 == 12.0);
    CHECK(row.from == "from above");
}

TEST_CASE("Faint type was asked for faint: its colour is judged, and not its contrast") {
    JudgedSheet sheet;
    add_ground(sheet);
    sheet.paint({30, 32, 60, 58}, white, white);
    // (1 - x) / (1 + x) = 0.48 is below a half.
    sheet.add(strokes, {40, 42, 47, 50}, Eigen::Vector3f::Constant(0.35f), Eigen::Vector3f::Constant(0.8f), 4);
    io::ReportRegion row = sheet.row("type and lines");
    CHECK(row.contrast_asked == Approx(0.65 / 1.35));
    CHECK(row.contrast == Approx(0.2 / 1.8));
    CHECK(row.good);
    CHECK(row.de2000 == 4.0);
    sheet.p.seen.looks[1].difference = 5.5;
    CHECK_THAT(sheet.row("type and lines").why, StartsWith("are printed as "));
    CHECK_THAT(sheet.row("type and lines").why, EndsWith(", 6 off"));
}

TEST_CASE("Regions of one kind and colour are one row: means by area, the place of the larger one") {
    JudgedSheet sheet;
    sheet.add(solid, {4, 40, 14, 50}, red, dark_red, 8);                                  // 1 mm2
    sheet.add(solid, {60, 10, 75, 30}, red + Eigen::Vector3f::Constant(0.002f), red, 4);  // 3 mm2
    sheet.p.seen.rims = {2, 6};
    JudgedRegions judged = sheet.judge();
    REQUIRE(judged.rows.size() == 1);
    io::ReportRegion row = judged.rows[0];
    CHECK(row.pieces == 2);
    CHECK(row.area_mm2 == Approx(4));
    CHECK(row.de2000.value_or(0) == Approx(5));
    CHECK(row.rim.value_or(0) == Approx(5));
    CHECK(row.place == "right");
    CHECK(row.place_mm[0] == Approx(6.75).margin(0.06));
    const Eigen::Vector3f mean = 0.25f * dark_red + 0.75f * red;
    const auto code = [&](Eigen::Index c) { return std::lround(255 * optics::srgb_encode(double(mean[c]))); };
    CHECK(row.printed ==
          "red (" + std::to_string(code(0)) + ", " + std::to_string(code(1)) + ", " + std::to_string(code(2)) + ")");
    CHECK(row.asked == "red (170, 60, 60)");
    // The larger one first: its place stays.
    std::swap(sheet.p.seen.regions[0], sheet.p.seen.regions[1]);
    CHECK(sheet.row("red").place == "right");
    // Of another kind, or of another colour, they are two.
    sheet.p.seen.regions[0].kind = paper;
    CHECK(sheet.judge().rows.size() == 2);
    sheet.p.seen.regions[0].kind = solid;
    const Eigen::Vector3d at = optics::oklab_from_linear_srgb(red.cast<double>());
    const auto lighter = [&](double by) {
        const Eigen::Vector3d oklab = at + Eigen::Vector3d(by, 0, 0);
        sheet.p.seen.regions[0].target = optics::linear_srgb_from_oklab(oklab).cast<float>();
        sheet.p.seen.regions[1].target = red;
        return sheet.judge().rows.size();
    };
    CHECK(lighter(0.029) == 1);
    CHECK(lighter(0.031) == 2);
}

TEST_CASE("Joined regions are out of reach where all of them are, and as uneven as the root of their mean square") {
    const Eigen::Vector3f green = of_codes(0, 255, 0);
    const double reach = five_resins().separation.gamut_distance(green);
    JudgedSheet sheet;
    sheet.add(solid, {4, 40, 14, 50}, green, green, reach);
    sheet.add(solid, {60, 10, 75, 30}, green, green, reach);
    CHECK(sheet.row("green").out_of_reach);
    sheet.p.seen.looks[1].difference = 3 * reach;
    CHECK_FALSE(sheet.row("green").out_of_reach);
    sheet.p.seen.looks = {sheet.p.seen.looks[1], sheet.p.seen.looks[0]};
    CHECK_FALSE(sheet.row("green").out_of_reach);
    // Flecks on one of them.
    JudgedSheet even;
    even.add(solid, {4, 40, 14, 50}, grey);
    even.add(solid, {60, 10, 75, 30}, grey);
    for (const std::uint32_t i : even.p.seen.regions[0].cells) even.p.seen.print[i] *= i % 2 ? 1.1f : 0.9f;
    const double joined = even.row("grey").unevenness.value_or(0);
    even.p.seen.regions.pop_back(), even.p.seen.looks.pop_back(), even.p.seen.rims.pop_back();
    const double alone = even.row("grey").unevenness.value_or(0);
    REQUIRE(alone > 0.3);
    CHECK(joined == Approx(alone / 2).epsilon(0.02));
}

TEST_CASE("Flat areas are flecked above a threshold, paper from six tenths of it, and spoilt from higher up") {
    const auto uneven = [](halftone::RegionKind kind, float by, bool& spoilt) {
        JudgedSheet sheet;
        sheet.add(kind, {10, 10, 50, 50}, grey);
        for (const std::uint32_t i : sheet.p.seen.regions[0].cells)
            sheet.p.seen.print[i] *= i % 3 == 1 ? 1 + by : 1 - by / 2;
        const JudgedRegions judged = sheet.judge();
        REQUIRE(judged.rows.size() == 1);
        spoilt = judged.spoilt[JudgedSheet::at(30, 30)] != 0;
        CHECK(judged.spoilt[JudgedSheet::at(60, 30)] == 0);
        CHECK(judged.spoilt.size() == sheet.p.target.size());
        return judged.rows[0];
    };
    bool spoilt = false;
    int even = 0, papers = 0, flecked = 0, worse = 0;
    for (const float by : {0.01f, 0.03f, 0.045f, 0.06f, 0.1f, 0.3f}) {
        CAPTURE(by);
        const io::ReportRegion of_solid = uneven(solid, by, spoilt);
        const double u = of_solid.unevenness.value_or(0);
        CHECK(of_solid.good == (u <= 0.8));
        CHECK(spoilt == (u > 1.8));
        if (!of_solid.good) CHECK(of_solid.why == fmt::format("is not even: flecked by {:.1f} CIEDE2000", u));
        const io::ReportRegion of_paper = uneven(paper, by, spoilt);
        CHECK(of_paper.unevenness.value_or(0) == u);
        CHECK(of_paper.good == (u <= 0.48));
        CHECK(spoilt == (u > 1.08));
        (u <= 0.48 ? even : u <= 0.8 ? papers : u <= 1.8 ? flecked : worse) += 1;
    }
    CHECK((even > 0 && papers > 0 && flecked > 0 && worse > 0));
}

TEST_CASE("Of less than half a square millimetre nothing is said, unless there is more of its colour") {
    JudgedSheet sheet;
    sheet.add(solid, {4, 40, 11, 47}, red, dark_red, 8);  // 0.49 mm2
    CHECK(sheet.judge().rows.empty());
    sheet.add(solid, {24, 40, 26, 41}, red, dark_red, 8);  // 0.51 in all
    sheet.p.seen.regions[1].interior = sheet.p.seen.regions[1].cells;
    CHECK(sheet.row("red").pieces == 2);
}

TEST_CASE("The worst come first: by how far they are from good, times the edge of what is seen of them") {
    JudgedSheet sheet;
    sheet.add(solid, {0, 0, 40, 40}, grey, of_codes(150, 150, 150), 5.5);  // 16 mm2: 1.1 x 4
    sheet.add(solid, {50, 40, 60, 50}, red, dark_red, 25);                 // 1 mm2: 5 x 1
    sheet.add(solid, {60, 0, 80, 30}, blue, blue, 4.9);                    // good
    const auto first = [&] { return sheet.judge().rows.front().asked.substr(0, 4); };
    CHECK(first() == "red ");
    CHECK(sheet.judge().rows.back().asked.starts_with("blue"));
    sheet.p.seen.looks[1].difference = 21;
    CHECK(first() == "grey");
    // A rim counts as it is wide, and flecks twice.
    JudgedSheet rims;
    rims.add(solid, {0, 0, 40, 40}, grey, grey, 5.5);     // 4.4
    rims.add(solid, {50, 30, 70, 50}, red, dark_red, 1);  // 4 mm2: a rim of 2 limits over half a millimetre of 2
    rims.p.seen.rims[1] = 40;                             // 4 x 0.5 x 2
    CHECK(rims.judge().rows.front().asked.starts_with("grey"));
    rims.p.seen.rims[1] = 48;  // 4.8
    CHECK(rims.judge().rows.front().asked.starts_with("red"));
    // What cannot be read, by how far its contrast lies below what is legible.
    JudgedSheet type;
    add_ground(type);
    type.paint({0, 28, 80, 60}, white, white);
    type.add(strokes, {40, 42, 50, 52}, black, Eigen::Vector3f::Constant(0.6f), 3);  // contrast 0.25: 2 x 1
    type.add(solid, {4, 34, 14, 44}, red, dark_red, 9);                              // 1.8 x 1
    CHECK(type.judge().rows.front().kind == "type and lines");
    type.p.seen.looks[2].difference = 11;
    CHECK(type.judge().rows.front().kind == "solid");
}

TEST_CASE("The inside of a letter is no type, what stands by itself is") {
    JudgedSheet sheet;
    sheet.add(paper, {0, 0, 80, 60}, white);
    const CellBox inside{40, 30, 48, 38};
    sheet.paint({37, 27, 51, 41}, black, black);  // the letter around it
    sheet.add(strokes, inside, white);
    std::erase_if(sheet.p.seen.regions[0].cells, [](std::uint32_t i) {
        return CellBox{37, 27, 51, 41}.holds(int(i % JudgedSheet::columns), int(i / JudgedSheet::columns));
    });
    CHECK_FALSE(sheet.has("type and lines"));
    // On a ground of another colour, of which nothing is near.
    sheet.p.seen.regions[0].target = blue;
    CHECK(sheet.has("type and lines"));
    sheet.p.seen.regions[0].target = white;
    // The ground of its colour is far away.
    std::erase_if(sheet.p.seen.regions[0].cells, [](std::uint32_t i) {
        return CellBox{28, 18, 60, 50}.holds(int(i % JudgedSheet::columns), int(i / JudgedSheet::columns));
    });
    CHECK(sheet.has("type and lines"));
}

TEST_CASE("Fine detail that lost its contrast is told of graphics: from how strong, how weak and how much of it on") {
    JudgedSheet sheet;
    add_ground(sheet);
    const auto lose = [&](const CellBox& box, float wanted, float kept) {
        for (const std::uint32_t i : JudgedSheet::cells_of(box)) sheet.p.seen.fine[i] = {wanted, kept};
    };
    lose({30, 44, 36, 49}, 0.08f, 0.59f);
    sheet.p.seen.fine[JudgedSheet::at(31, 45)] = {0.2f, 0.2f};  // the worst
    sheet.paint({31, 45, 32, 46}, blue, grey);
    const io::ReportRegion row = sheet.row("fine detail");
    CHECK(row.area_mm2 == Approx(0.3));
    CHECK(row.contrast == Approx((29 * 0.59 + 0.2) / 30));
    CHECK(row.contrast_asked == 1);
    CHECK(row.asked == "blue (60, 90, 140)");
    CHECK(row.printed == "grey (110, 110, 110)");
    CHECK(row.place_mm[0] == Approx(3.15));
    CHECK(row.place_mm[1] == Approx(4.55));
    CHECK_FALSE(row.good);
    CHECK(row.why == "keeps 0.58 of its contrast: what is as fine as that is hard to make out");
    // Enough is kept, hardly anything was there, or it is hardly anywhere.
    lose({30, 44, 36, 49}, 0.08f, 0.6f);
    CHECK_FALSE(sheet.has("fine detail"));
    lose({30, 44, 36, 49}, 0.079f, 0.1f);
    CHECK_FALSE(sheet.has("fine detail"));
    lose({30, 44, 36, 49}, 0, 1), lose({30, 44, 34, 50}, 0.1f, 0.3f);
    CHECK_FALSE(sheet.has("fine detail"));  // 0.24
    // On a body what is smaller and fainter is told: eyes.
    sheet.becomes_body();
    CHECK(sheet.has("fine detail"));
    lose({30, 44, 34, 50}, 0, 1), lose({30, 44, 35, 46}, 0.05f, 0.3f);
    sheet.p.seen.fine[JudgedSheet::at(30, 47)] = {0.05f, 0.3f};
    CHECK(sheet.has("fine detail"));
    lose({30, 44, 35, 46}, 0.049f, 0.3f);
    CHECK_FALSE(sheet.has("fine detail"));
    // Of a photograph, whose flat areas are less than three tenths, the texture says it.
    lose({30, 44, 35, 49}, 0.2f, 0.1f);
    CHECK(sheet.has("fine detail"));
    sheet.p.seen.regions[0].area_mm2 = 0.29 * 48;
    CHECK_FALSE(sheet.has("fine detail"));
}

TEST_CASE("Contrast that is lost in an area, between two of them or beside type is no fine detail") {
    JudgedSheet sheet;
    add_ground(sheet);  // up to row 28
    sheet.add(solid, {0, 31, 80, 45}, blue);
    sheet.add(strokes, {40, 52, 50, 54}, black);
    sheet.p.seen.regions[2].interior = sheet.p.seen.regions[2].cells;
    const auto told = [&](const CellBox& box) {
        for (halftone::FineContrast& fine : sheet.p.seen.fine) fine = {};
        for (const std::uint32_t i : JudgedSheet::cells_of(box)) sheet.p.seen.fine[i] = {0.2f, 0.1f};
        double area = 0;
        for (const io::ReportRegion& row : sheet.judge().rows)
            if (row.kind == "fine detail") area = row.area_mm2;
        return area;
    };
    CHECK(told({0, 10, 80, 14}) == 0);             // in the ground
    CHECK(told({0, 28, 80, 31}) == Approx(1.6));   // the middle one of three rows is beside both
    CHECK(told({0, 45, 80, 47}) == Approx(1.6));   // along one of them
    CHECK(told({40, 50, 50, 52}) == 0);            // two cells from the line
    CHECK(told({38, 49, 52, 50}) == 0);            // 0.14 mm2: hardly anywhere
    CHECK(told({30, 48, 60, 50}) == Approx(0.6));  // three of them
    CHECK(told({10, 47, 20, 60}) == Approx(1.3));  // in the open
}

TEST_CASE("A texture that comes out blurred is told with its share, and all of it is spoilt") {
    JudgedSheet sheet;
    const CellBox fur{10, 20, 50, 40}, more{60, 50, 72, 58};
    for (const CellBox& box : {fur, more})
        for (const std::uint32_t i : JudgedSheet::cells_of(box)) sheet.p.seen.texture[i] = {0.1f, 0.25f};
    sheet.paint(fur, grey, blue), sheet.paint(more, grey, blue);
    const JudgedRegions judged = sheet.judge();
    const io::ReportRegion row = JudgedSheet::row(judged, "texture");
    CHECK(row.area_mm2 == Approx(8.96));
    CHECK(row.contrast == Approx(0.25));
    CHECK(row.contrast_asked == 1);
    CHECK(row.why == "keeps 0.25 of its contrast over 19 % of what is seen: it comes out blurred");
    CHECK_FALSE(row.good);
    CHECK(row.pieces == 2);
    CHECK(row.asked == "grey (110, 110, 110)");
    CHECK(row.printed == "blue (60, 90, 140)");
    CHECK(row.place_mm[0] == Approx(3).margin(0.06));
    CHECK(row.place_mm[1] == Approx(3).margin(0.06));
    CHECK(std::accumulate(judged.spoilt.begin(), judged.spoilt.end(), 0) == 896);
    CHECK(judged.spoilt[JudgedSheet::at(61, 51)] == 1);
}

TEST_CASE("Thin walls are told with their mean, their pieces and where they are worst") {
    JudgedSheet sheet;
    sheet.becomes_body();
    const CellBox wall{10, 20, 20, 40}, other{50, 20, 56, 30};
    sheet.walls.cells = JudgedSheet::cells_of(wall);
    const auto more = JudgedSheet::cells_of(other);
    sheet.walls.cells.insert(sheet.walls.cells.end(), more.begin(), more.end());
    sheet.walls.wall_mm = 0.4;
    sheet.paint(wall, red, blue), sheet.paint(other, red, blue);
    for (const std::uint32_t i : sheet.walls.cells) sheet.p.seen.difference[i] = 4.5;
    for (const std::uint32_t i : more) sheet.p.seen.difference[i] = 6;
    sheet.p.seen.difference[JudgedSheet::at(17, 22)] = 7.7;
    const auto judged = sheet.judge();
    io::ReportRegion row = JudgedSheet::row(judged, "thin walls");
    const double mean = (199 * 4.5 + 7.7 + 60 * 6) / 260;
    CHECK(row.de2000.value_or(0) == Approx(mean));
    CHECK(row.good);
    CHECK(row.why.empty());
    CHECK(row.area_mm2 == Approx(2.6));
    CHECK(row.pieces == 2);
    CHECK(row.asked == "red (170, 60, 60)");
    CHECK(row.printed == "blue (60, 90, 140)");
    CHECK(row.place_mm[0] == Approx(1.75));
    CHECK(row.place_mm[1] == Approx(2.25));
    sheet.limits.bad = mean - 0.01;
    row = sheet.row("thin walls");
    CHECK_FALSE(row.good);
    CHECK(row.why == "let light pass, 5 off on average: they are 0.4 mm thick");
    // Boxes as large as the walls are thick, if that is more than a millimetre, hang together.
    sheet.walls.wall_mm = 3;
    CHECK(sheet.row("thin walls").pieces == 1);
    sheet.walls.cells.resize(49);
    CHECK_FALSE(sheet.has("thin walls"));
    sheet.walls.cells = JudgedSheet::cells_of({10, 20, 17, 28});  // 0.56
    CHECK(sheet.has("thin walls"));
}

TEST_CASE("Where nothing is flat the largest place of the worst quarter of what is off is told") {
    JudgedSheet sheet;
    const auto off = [&](const CellBox& box, double by) {
        for (const std::uint32_t i : JudgedSheet::cells_of(box)) sheet.p.seen.difference[i] = by;
    };
    sheet.paint({10, 10, 30, 30}, red, dark_red), sheet.paint({60, 40, 76, 56}, blue, grey);
    off({0, 0, 80, 60}, 0), off({10, 10, 30, 30}, 6), off({60, 40, 76, 56}, 9);  // 400 and 256 cells; a quarter: 165
    const io::ReportRegion row = sheet.row("colour");
    CHECK(row.asked == "blue (60, 90, 140)");
    CHECK(row.de2000.value_or(0) == Approx(9));
    CHECK(row.area_mm2 <= 1.66);
    CHECK(row.area_mm2 > 1);
    CHECK(row.place == "upper right");
    CHECK(row.printed == "grey (110, 110, 110)");
    CHECK(row.why == "is printed as grey (110, 110, 110), 9 off");
    CHECK_FALSE(row.good);
    // Of what is at the limit, or on less than a fiftieth of what is seen, nothing.
    off({0, 0, 80, 60}, 5);
    CHECK(sheet.judge().rows.empty());
    off({0, 0, 80, 60}, 0), off({0, 0, 12, 8}, 20);  // 96 of 4800
    CHECK(sheet.judge().rows.empty());
    off({12, 0, 13, 2}, 20);
    CHECK(sheet.judge().rows.size() == 1);
    // Nor where another thing is wrong already.
    sheet.add(solid, {40, 20, 60, 40}, red, dark_red, 8);
    CHECK_FALSE(sheet.has("colour"));
    sheet.p.seen.looks[0].difference = 1;
    CHECK(sheet.has("colour"));
}

TEST_CASE("How far a row is seen weighs each of its cells by its area") {
    JudgedSheet sheet;
    for (const std::uint32_t i : JudgedSheet::cells_of({0, 0, 80, 60})) {
        optics::SurfaceCell& cell = sheet.p.predicted.surface.cells[i];
        if (i % JudgedSheet::columns < 40) cell.normal = {0, 0, -1}, cell.centre_mm[2] = 0;  // from below
    }
    sheet.becomes_body();
    sheet.add(solid, {30, 20, 50, 40}, red, dark_red, 8);
    for (const std::uint32_t i : sheet.p.seen.regions[0].cells)
        if (i % JudgedSheet::columns < 40) sheet.p.predicted.surface.cells[i].area_mm2 = 0.03f;
    const io::ReportRegion row = sheet.row("red");
    double seen = 0, area = 0;
    for (const std::uint32_t i : sheet.p.seen.regions[0].cells) {
        const double a = double(sheet.p.predicted.surface.cells[i].area_mm2);
        area += a, seen += a * sheet.p.sides.weight(i);
    }
    CHECK(seen / area < 0.5);  // an eighth of most of three quarters
    CHECK(row.seen_share == Approx(seen / area));
    CHECK(row.from == "from above");  // of the cells, not of what lies below
}
