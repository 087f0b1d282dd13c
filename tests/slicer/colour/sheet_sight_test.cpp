// SPDX-License-Identifier: GPL-3.0-or-later
//
// From where cells are seen, how even areas are, and what eyes make of target and print, where each can be worked out.
#include <catch2/catch.hpp>

#include <cmath>
#include <memory>
#include <vector>

#include "judged_sheet.h"
#include "slicer/colour/evenness.h"
#include "slicer/colour/sides_seen.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using enum halftone::RegionKind;

namespace {

const Eigen::Vector3f grey = of_codes(150, 150, 150);

/// The sheet folded along column 40, its left half down (a ridge) or up (a groove) by 45 degrees.
optics::Surface folded(float down) {
    optics::Surface surface = JudgedSheet().p.predicted.surface;
    const float c = std::sqrt(0.5f);
    for (optics::SurfaceCell& cell : surface.cells) {
        const float right = cell.centre_mm[0] - 4;
        if (right < 0) cell.centre_mm = {4 + c * right, cell.centre_mm[1], 2 + down * c * right};
        if (right < 0) cell.normal = {-down * c, 0, c};
    }
    return surface;
}

}  // namespace

TEST_CASE("A place that looks up is seen half from above and half from around, a wall from its side and a bit below") {
    JudgedSheet sheet;
    std::vector<optics::SurfaceCell>& cells = sheet.p.predicted.surface.cells;
    struct Wall {
        std::array<float, 3> normal, at;
        Side side;
        const char* words;
    };
    const std::vector<Wall> walls{
        {{0, 0, 1}, {4, 3, 2}, Side::top, "from above"},        {{0, 0, -1}, {4, 3, 0}, Side::bottom, "from below"},
        {{-1, 0, 0}, {0, 3, 1}, Side::left, "from the left"},   {{1, 0, 0}, {8, 3, 1}, Side::right, "from the right"},
        {{0, -1, 0}, {4, 0, 1}, Side::front, "from the front"}, {{0, 1, 0}, {4, 6, 1}, Side::back, "from the back"}};
    cells.resize(6000, cells.front());
    std::vector<std::vector<std::uint32_t>> of(6);
    for (std::uint32_t i = 0; i < 6000; ++i) {
        const Wall& wall = walls[i % 6];
        cells[i].normal = wall.normal, cells[i].centre_mm = wall.at, of[i % 6].push_back(i);
        cells[i].area_mm2 = 0.02f;
    }
    sheet.becomes_body();
    for (std::size_t w = 0; w < 6; ++w) {
        CAPTURE(walls[w].words);
        CHECK(sheet.p.sides.main_side(of[w]) == walls[w].side);
        CHECK(std::string(from_words(walls[w].side)) == walls[w].words);
        std::array<double, all_sides> from{};
        double weight = 0;
        for (const std::uint32_t i : of[w]) {
            for (std::size_t s = 0; s < all_sides; ++s) from[s] += sheet.p.sides.from(static_cast<Side>(s), i) / 1000;
            weight += sheet.p.sides.weight(i) / 1000;
            CHECK(sheet.seen[i] == Approx(0.02 * sheet.p.sides.weight(i)));
        }
        // Of the cosine law: sines of 45 degrees to the horizon for half, and of 15 degrees below it.
        if (w == 0) {
            CHECK(from[std::size_t(Side::top)] == Approx(0.5).margin(1e-9));
            CHECK(weight == Approx(1).margin(1e-9));
            for (const Side side : {Side::left, Side::right, Side::front, Side::back})
                CHECK(from[std::size_t(side)] == Approx(0.125).margin(0.01));
        } else if (w == 1) {
            // sin(15 degrees)^2 of it goes nearly level, 1.6 of 24 directions.
            CHECK(from[std::size_t(Side::bottom)] == Approx(22.0 / 24));
            CHECK(weight == Approx(0.125 * 22 / 24 + 2.0 / 24));
        } else {
            // Of a wall: what lies within an angle above the horizon is (angle + sin(2 angle) / 2) / pi from the
            // middle.
            const double pi = std::acos(-1), up = 0.5 - (pi / 4 + 0.5) / pi, down = 0.5 - (pi / 12 + 0.25) / pi;
            CHECK(from[std::size_t(Side::top)] == Approx(up).margin(0.01));
            CHECK(from[std::size_t(Side::bottom)] == Approx(down).margin(0.01));
            CHECK(weight == Approx(1 - down + 0.125 * down).margin(0.01));
            CHECK(from[std::size_t(walls[w].side)] > 0.4);
        }
    }
    sheet.stays_picture();
    CHECK(sheet.p.sides.from(Side::top, 1) == 1);
    CHECK(sheet.p.sides.weight(1) == 1);
    CHECK(sheet.p.sides.main_side(of[1]) == Side::top);
}

TEST_CASE("Terms of edges are what a blur changes of the target, and how ridges lie to their surroundings") {
    const std::vector<Eigen::Vector3f> even(4800, grey);
    for (const EdgeTerms& terms : edge_terms(JudgedSheet().p.predicted.surface, even, even))
        REQUIRE(terms.cwiseAbs().maxCoeff() < 0.05);
    // A light half beside a dark one: cells of the dark one gain light, of the light one they lose it, to 0.5 mm and
    // more by the wide Gaussian.
    std::vector<Eigen::Vector3f> halves(even);
    for (std::uint32_t i = 0; i < 4800; ++i) halves[i].setConstant(i % 80 < 40 ? 0.1f : 0.6f);
    const auto at = [&](int x) {
        return edge_terms(JudgedSheet().p.predicted.surface, halves, halves)[JudgedSheet::at(x, 30)];
    };
    const EdgeTerms dark = at(39), light = at(40), far = at(33), farther = at(10);
    CHECK((dark[0] > 5 && dark[3] > 5 && light[0] < -3 && light[3] < -3));
    CHECK(std::abs(dark[1]) + std::abs(dark[2]) < 0.1);
    CHECK(far[3] > 2 * far[0]);
    CHECK(farther.head<6>().cwiseAbs().maxCoeff() < 0.1);
    CHECK(std::abs(dark[6]) < 1e-3);
    CHECK(std::abs(dark[7]) < 1e-3);
    // `seen` is what is taken away, whatever was asked for.
    const std::vector<EdgeTerms> darker =
        edge_terms(JudgedSheet().p.predicted.surface, even, std::vector<Eigen::Vector3f>(4800, 0.5f * grey));
    const double step = lab_of(grey)[0] - lab_of(0.5f * grey)[0];
    CHECK(darker[2400][0] == Approx(step).margin(0.05));
    CHECK(darker[2400][3] == Approx(step).margin(0.05));
    // At a ridge what lies around is behind the surface, in a groove before it, and normals part.
    const std::vector<EdgeTerms> ridge = edge_terms(folded(1), even, even), groove = edge_terms(folded(-1), even, even);
    const std::uint32_t fold = JudgedSheet::at(40, 30), plane = JudgedSheet::at(70, 30);
    CHECK((ridge[fold][6] < -0.03 && ridge[fold][6] > -0.3));
    CHECK(groove[fold][6] == Approx(-ridge[fold][6]).epsilon(0.05));
    CHECK((ridge[fold][7] > 0.03 && ridge[fold][7] < 0.12));
    CHECK(groove[fold][7] == Approx(ridge[fold][7]).epsilon(0.05));
    CHECK(std::abs(ridge[plane][6]) < 1e-3);
    CHECK(std::abs(ridge[plane][7]) < 1e-3);
}

TEST_CASE("Unevenness is the root mean square, by area, of what a cell differs by from those around it") {
    JudgedSheet sheet;
    sheet.add(solid, {10, 10, 50, 50}, grey, grey, 0, 4);
    const halftone::ColourRegion& region = sheet.p.seen.regions[0];
    const std::vector<EdgeTerms> none(4800, EdgeTerms::Zero());
    const Eigen::Vector3f up = 1.1f * grey, down = 0.9f * grey;
    const auto uneven = [&](const std::vector<Eigen::Vector3f>& print) {
        const halftone::CellNeighbours cells(sheet.p.predicted.surface);
        return unevenness_of(region, cells, sheet.p.target, print, none);
    };
    // Stripes of a cell: the mean of what touches one is a third of the other sign, and nothing after some rounds.
    std::vector<Eigen::Vector3f> stripes(sheet.p.target);
    for (const std::uint32_t i : region.cells) stripes[i] = i % 2 ? up : down;
    const Eigen::Vector3d mean = 0.5 * (lab_of(up) + lab_of(down));
    const double of_up = optics::ciede2000(mean, lab_of(up)), of_down = optics::ciede2000(mean, lab_of(down));
    CHECK(uneven(stripes) == Approx(std::sqrt((of_up * of_up + of_down * of_down) / 2)).epsilon(0.01));
    // All of it off, or what lies outside of it, is even.
    CHECK(uneven(std::vector<Eigen::Vector3f>(4800, up)) < 1e-6);
    std::vector<Eigen::Vector3f> beside(sheet.p.target);
    for (const std::uint32_t i : JudgedSheet::cells_of({0, 0, 80, 9})) beside[i] = i % 2 ? up : down;
    CHECK(uneven(beside) < 1e-6);
    // By area: cells twice as large where it is even.
    std::vector<Eigen::Vector3f> half(stripes);
    for (const std::uint32_t i : region.cells)
        if (i / JudgedSheet::columns < 30) half[i] = grey;
    const double alike = uneven(half);
    for (const std::uint32_t i : region.cells)
        if (i / JudgedSheet::columns < 30) sheet.p.predicted.surface.cells[i].area_mm2 = 0.03f;
    CHECK(uneven(half) == Approx(alike * std::sqrt(0.5)).epsilon(0.02));
    // What goes by terms of edges is none.
    std::vector<EdgeTerms> edges(none);
    for (const std::uint32_t i : region.cells) edges[i][0] = i % 2 ? 3 : -3;
    const halftone::CellNeighbours cells(sheet.p.predicted.surface);
    CHECK(unevenness_of(region, cells, sheet.p.target, stripes, edges) < 0.05 * uneven(stripes));
}

TEST_CASE("The loop's own prediction is that of its cells in three channels, before it and after") {
    JudgedSheet sheet;
    sheet.p.target[7] = of_codes(90, 20, 20);
    JobLoop loop;
    loop.model = "transport";
    loop.cells = std::make_shared<const LoopCells>(
        ViewedCells{sheet.p.predicted.surface, sheet.p.target, {100, 90, 80}}, sheet.body, DepthZones{}, 1);
    loop.result.state.shown = loop.result.state.open = sheet.p.target;
    loop.result.state.shown[7] = Eigen::Vector3f(0.25f, 0.5f, 0.75f), loop.result.state.open[7] = of_codes(9, 9, 9);
    const JobPrediction p = prediction_of_loop(loop, std::move(sheet.p.volume));
    CHECK(p.model == "transport, in the loop's cells");
    CHECK(p.predicted.channels == 3);
    REQUIRE(p.predicted.value.size() == 3 * 4800);
    CHECK((p.predicted.value[21] == 0.25f && p.predicted.value[22] == 0.5f && p.predicted.value[23] == 0.75f));
    CHECK(p.predicted.rgb[7] == Eigen::Vector3f(0.25f, 0.5f, 0.75f));
    CHECK(p.open_loop[7] == of_codes(9, 9, 9));
    CHECK(p.target[7] == of_codes(90, 20, 20));
    CHECK(p.cell_um == std::array<double, 3>{100, 90, 80});
    CHECK(p.volume.size() == std::array{80, 60, 20});
    const double off = optics::ciede2000(lab_of(p.target[7]), lab_of(p.predicted.rgb[7]));
    CHECK(p.difference[7] == Approx(off));
    CHECK(p.difference[8] == 0);
    CHECK(p.summary.mean == Approx(off / 4800));
    CHECK(p.summary.max == Approx(off));
    // Where it looked once more that look stands.
    loop.result.last_look.assign(4800, of_codes(1, 2, 3));
    const JobPrediction last = prediction_of_loop(loop, {});
    CHECK(last.model == "transport");
    CHECK(last.predicted.rgb[7] == of_codes(1, 2, 3));
    CHECK(last.open_loop[7] == of_codes(9, 9, 9));
}

TEST_CASE("What is seen of a print is over its paper's level where eyes adapt, region by region") {
    JudgedSheet sheet;
    const Eigen::Vector3f white = of_codes(255, 255, 255), red = of_codes(170, 60, 60);
    sheet.paint({0, 0, 80, 60}, white, 0.8f * white);
    sheet.paint({20, 20, 45, 45}, red, 0.8f * red);
    const SeenPrint adapted = seen_from(sheet.p, 300, true), absolute = seen_from(sheet.p, 300, false);
    const double share = (4800 - 625) / 4800.0, certain = share * share / (share * share + 0.01);
    CHECK(adapted.paper == Approx(1 - 0.85 * certain * 0.2));
    CHECK(absolute.paper == 1);
    REQUIRE(adapted.regions.size() == 2);
    REQUIRE((adapted.looks.size() == 2 && adapted.rims.size() == 2));
    CHECK(adapted.regions[0].kind == paper);
    CHECK(adapted.rims[0] == 0);
    for (std::size_t r = 0; r < 2; ++r) {
        CHECK(adapted.looks[r].difference < 1);
        CHECK(absolute.looks[r].difference > 2);
    }
    CHECK(std::abs(adapted.rims[1]) < 0.5);
    const std::uint32_t middle = JudgedSheet::at(32, 32), corner = JudgedSheet::at(70, 5);
    CHECK(adapted.difference[corner] < 1);
    CHECK(adapted.print[corner].isApprox(0.8f / adapted.paper * white, 0.01f));
    CHECK(absolute.print[corner].isApprox(0.8f * white, 0.01f));
    CHECK(optics::ciede2000(lab_of(adapted.target[middle]), lab_of(red)) < 6);  // white is near
    CHECK((adapted.fine.size() == 4800 && adapted.texture.size() == 4800 && adapted.difference.size() == 4800));
    CHECK(adapted.texture[middle].kept == 1);  // flat: it is none
    // A rim of another hue around the solid.
    sheet.p.predicted.rgb = sheet.p.target;
    for (const std::uint32_t i : JudgedSheet::cells_of({17, 17, 48, 48}))
        if (!CellBox{23, 23, 42, 42}.holds(int(i % 80), int(i / 80))) sheet.p.predicted.rgb[i] = of_codes(60, 200, 60);
    const SeenPrint rimmed = seen_from(sheet.p, 300, false);
    CHECK(rimmed.rims[1] > 10);
    CHECK(rimmed.difference[JudgedSheet::at(18, 32)] > 20);
}
