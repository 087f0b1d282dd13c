// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a verdict looks at: from where places are seen, where they are, what of the type is read, how even paper is.
#include <array>
#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/colour/colour.h"
#include "slicer/colour/evenness.h"
#include "slicer/colour/place_words.h"
#include "slicer/colour/region_verdict.h"
#include "slicer/colour/sides_seen.h"
#include "slicer/colour/tried_advice.h"
#include "slicer/colour/type_size.h"
#include "slicer/print/dot_letters.h"
#include "tests/slicer/colour/drawn_page.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr double voxel_mm = 0.1;

void add_box(VisibleSurface& surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const auto first = static_cast<std::uint32_t>(surface.positions_mm.size());
    for (int c = 0; c < 8; ++c)
        surface.positions_mm.emplace_back(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(),
                                          c & 4 ? high.z() : low.z());
    for (const auto& [a, b, c] : std::vector<std::array<std::uint32_t, 3>>{{0, 2, 3},
                                                                           {0, 3, 1},
                                                                           {0, 1, 5},
                                                                           {0, 5, 4},
                                                                           {2, 6, 7},
                                                                           {2, 7, 3},
                                                                           {0, 4, 6},
                                                                           {0, 6, 2},
                                                                           {1, 3, 7},
                                                                           {1, 7, 5},
                                                                           {4, 5, 7},
                                                                           {4, 7, 6}})
        surface.triangles.push_back({first + a, first + b, first + c});
    surface.source_triangle.assign(surface.triangles.size(), 0);
    surface.source_uv.resize(surface.triangles.size());
}

/// A cube of 4 mm, and a roof of 4 mm over its left half, 0.5 mm above it.
struct RoofedCube {
    RoofedCube() {
        VisibleSurface shape;
        add_box(shape, {0, 0, 0}, {4, 4, 4});
        add_box(shape, {0, 0, 4.5}, {2, 4, 5});
        body.surface = SurfaceIndex(std::move(shape));
        body.grid.size = {40, 40, 50};
        body.grid.pitch_mm = {voxel_mm, voxel_mm, voxel_mm};
        body.grid.origin_mm = Eigen::Vector3d::Zero();
        volume = optics::make_resin_volume({40, 40, 50}, {voxel_mm, voxel_mm, voxel_mm}, [](int x, int, int z) {
            return z < 40 || (z >= 45 && x < 20) ? optics::Material{1} : optics::air;
        });
        surface = optics::find_surface({.volume = &volume}, {1, 1, 1}, optics::SurfacePart::all);
    }
    /// Mean over the cells that look so and lie within half a millimetre of a place.
    [[nodiscard]] double weight(const SidesSeen& sides, const Eigen::Vector3d& at, const Eigen::Vector3d& out) const {
        double sum = 0;
        int n = 0;
        for (std::size_t i = 0; i < surface.cells.size(); ++i) {
            const auto &c = surface.cells[i].centre_mm, &d = surface.cells[i].normal;
            if ((Eigen::Vector3d(c[0], c[1], c[2]) - at).norm() < 0.5 &&
                Eigen::Vector3d(d[0], d[1], d[2]).dot(out) > 0.95)
                sum += sides.weight(i), ++n;
        }
        REQUIRE(n > 10);
        return sum / n;
    }
    JobBody body;
    optics::ResinVolume volume;
    optics::Surface surface;
};

/// A slab's top of 20 x 12 mm in cells of 0.1 mm: white, with what `ink` says in black; printed as `print` says.
struct Page {
    template <class Ink, class Print>
    Page(const Ink& ink, const Print& print) {
        p.volume = optics::make_resin_volume({200, 120, 2}, {voxel_mm, voxel_mm, voxel_mm},
                                             [](int, int, int) { return optics::Material{1}; });
        p.predicted.surface = optics::find_surface({.volume = &p.volume}, {1, 1, 1}, optics::SurfacePart::top);
        for (const optics::SurfaceCell& cell : p.predicted.surface.cells) {
            const bool black = ink(cell.cell[0], cell.cell[1]);
            p.target.push_back(Eigen::Vector3f::Constant(black ? 0.01f : 1.0f));
            p.predicted.rgb.push_back(Eigen::Vector3f::Constant(print(cell.cell[0], cell.cell[1], black)));
        }
        p.seen.regions = halftone::colour_regions(p.predicted.surface, p.target);
    }
    JobPrediction p;
};

/// Capitals of dots of this many cells; they stand on a line and begin at a column.
bool is_letter(int x, int y, int line, int dot) {
    const std::string text = "SLICED AT SIX BY WHOMEVER HAS ONE";
    const int i = (x - 10) / dot, j = 6 - (y - line) / dot;
    if (x < 10 || y < line || j < 0 || i / 6 >= int(text.size()) || i % 6 == 5) return false;
    if (text[std::size_t(i / 6)] == ' ') return false;
    const auto rows = dot_letter(text[std::size_t(i / 6)]);
    return (rows[std::size_t(j)] >> (4 - i % 6) & 1) != 0;
}

/// A line of letters of 1.4 mm height in the upper half, of 0.7 mm in the lower one.
bool lines_of_type(int x, int y) { return x < 190 && (is_letter(x, y, 70, 2) || is_letter(x, y, 30, 1)); }

}  // namespace

TEST_CASE(
    "What lies open to the sky counts whole, walls less, the underside hardly, and what is roofed over by its sides") {
    const RoofedCube cube;
    const SidesSeen sides(cube.body, cube.surface, Progress());
    CHECK(cube.weight(sides, {3.2, 2, 4}, {0, 0, 1}) > 0.9);
    CHECK(cube.weight(sides, {1, 2, 5}, {0, 0, 1}) == Approx(1).margin(0.02));
    CHECK(cube.weight(sides, {2, 0, 2}, {0, -1, 0}) == Approx(0.71).margin(0.03));
    CHECK(cube.weight(sides, {2, 2, 0}, {0, 0, -1}) == Approx(0.18).margin(0.03));
    const double under_roof = cube.weight(sides, {0.7, 2, 4}, {0, 0, 1});
    CHECK((under_roof > 0.05 && under_roof < 0.4));
    std::vector<std::uint32_t> front, under;
    for (std::uint32_t i = 0; i < cube.surface.cells.size(); ++i) {
        if (cube.surface.cells[i].normal[1] < -0.9f) front.push_back(i);
        if (cube.surface.cells[i].normal[2] < -0.9f && cube.surface.cells[i].centre_mm[2] < 0.05f) under.push_back(i);
    }
    CHECK(sides.main_side(front) == Side::front);
    CHECK(sides.main_side(under) == Side::bottom);
    // The same from every run.
    const SidesSeen again(cube.body, cube.surface, Progress());
    for (std::size_t i = 0; i < cube.surface.cells.size(); ++i) REQUIRE(again.weight(i) == sides.weight(i));
}

TEST_CASE("A place is said in words, by thirds of the box") {
    const std::array<double, 3> box{30, 30, 60}, flat{40, 30, 4};
    CHECK(place_in_box({5, 3, 55}, box, false) == "upper left front");
    CHECK(place_in_box({25, 28, 5}, box, false) == "lower right back");
    CHECK(place_in_box({15, 15, 30}, box, false) == "middle");
    CHECK(place_in_box({15, 1, 30}, box, false) == "front");
    CHECK(place_in_box({35, 25, 4}, flat, true) == "upper right");
    // A plate has no front to speak of.
    CHECK(place_in_box({15, 0.1, 55}, {30, 2, 60}, false) == "upper");
}

TEST_CASE("Letters are read down to the size that normal eyes read at their contrast") {
    // Fujita et al. 2008: contrast by what is missing of the paper's light, acuity in logMAR; 300 mm away five minutes
    // are 0.436 mm, and an x-height is half of a face.
    struct Measured {
        double lacks, log_mar;
    };
    for (const auto& [lacks, log_mar] : {Measured{1, -0.08}, {0.4, 0.03}, {0.2, 0.13}, {0.1, 0.26}}) {
        CAPTURE(lacks);
        const double contrast = lacks / (2 - lacks), size_mm = 2 * 0.4363 * std::pow(10, log_mar);
        CHECK(legibility_of(contrast, 1, 0.99 * size_mm, 300) == Legibility::lost);
        CHECK(legibility_of(contrast, 1, 1.01 * size_mm, 300) != Legibility::lost);
        CHECK(legibility_of(contrast, 1, 1.01 * size_mm, 306) == Legibility::lost);
    }
    CHECK(legibility_of(0.04, 1, 20, 300) == Legibility::lost);
    CHECK(legibility_of(0.49, 1, 3, 300) == Legibility::pale);
    CHECK(legibility_of(0.51, 1, 3, 300) == Legibility::well);
    CHECK(legibility_of(0.19, 0.3, 3, 300) == Legibility::well);  // little more was asked for
}

TEST_CASE("Below the size where its contrast is lost type is said to be unreadable, and nothing where all is read") {
    const auto small_is_lost = [](int, int y, bool black) { return black ? (y < 50 ? 0.75f : 0.05f) : 1.0f; };
    const Page page(lines_of_type, small_is_lost);
    const auto type = unreadable_type(page.p, 300);
    REQUIRE(type);
    CHECK(type->smallest_mm == Approx(0.7 / 0.72).margin(0.05));
    CHECK(type->largest_mm == Approx(1.4 / 0.72).margin(0.05));
    CHECK((type->below_mm > type->smallest_mm && type->below_mm < type->largest_mm));
    CHECK(type->unread == 24);
    CHECK(type->contrast_asked > 0.9);
    CHECK(type->contrast < 0.5);
    // As much larger as sight needs, whatever the palest tenth does.
    CHECK(type->times == Approx(1.1).margin(0.06));  // 1 mm at a contrast of 0.14: sight reads 1.1 mm
    const Page palest(lines_of_type, [&](int x, int y, bool black) {
        return black && y < 50 && x < 12 ? 0.999f : small_is_lost(x, y, black);
    });
    CHECK(unreadable_type(palest.p, 300)->times == Approx(type->times).epsilon(0.06));
    // What has next to no contrast is read at no size, and none is advised.
    const Page gone(lines_of_type, [](int, int, bool black) { return black ? 0.9995f : 1.0f; });
    CHECK(unreadable_type(gone.p, 300)->times == 1);
    const Page sharp(lines_of_type, [](int, int, bool black) { return black ? 0.05f : 1.0f; });
    CHECK(unreadable_type(sharp.p, 300)->is_read_well());
    // Sight has its limit, too: nobody reads 1.4 mm from three metres.
    CHECK_FALSE(unreadable_type(sharp.p, 3000)->is_read_well());
    const Page all_lost(lines_of_type, [](int, int, bool black) { return black ? 0.95f : 1.0f; });
    const auto all = unreadable_type(all_lost.p, 300);
    REQUIRE(all);
    CHECK((all->unread == all->letters && all->pale == 0));
    // A quarter darker than the paper capitals of 1.4 mm are read, if they are pale; from six tenths of a metre not.
    const Page grey(lines_of_type, [](int, int, bool black) { return black ? 0.75f : 1.0f; });
    const auto pale = unreadable_type(grey.p, 300);
    REQUIRE(pale);
    CHECK(pale->unread == 24);
    CHECK(pale->unread + pale->pale == pale->letters);
    CHECK(pale->pale_contrast == Approx(0.143).margin(0.015));
    CHECK(unreadable_type(grey.p, 600)->pale == 0);
    const auto upper_line = [](int x, int y) { return y >= 50 && lines_of_type(x, y); };
    const auto only_pale =
        unreadable_type(Page(upper_line, [](int, int, bool black) { return black ? 0.6f : 1.0f; }).p, 300);
    REQUIRE(only_pale);
    CHECK((only_pale->unread == 0 && only_pale->below_mm == 0 && only_pale->pale == only_pale->letters));
    // A few spots are no type, nor is a checkerboard that stands on nothing.
    const auto spots = [](int x, int y) { return (x == 20 || x == 150) && y >= 50 && y < 60; };
    CHECK_FALSE(unreadable_type(Page(spots, [](int, int, bool black) { return black ? 0.6f : 1.0f; }).p, 300));
    CHECK(type_size_text(2.117) == "2.1 mm (6 pt)");
    CHECK(type_size_text(0.53) == "0.5 mm (1.5 pt)");
}

TEST_CASE("Paper that is grey all over is even, and flecked paper is not, however near its mean is") {
    const auto blank = [](int, int) { return false; };
    const auto unevenness = [&](const auto& print) {
        const Page page(blank, print);
        REQUIRE(page.p.seen.regions.size() == 1);
        return unevenness_of(page.p.seen.regions[0], halftone::CellNeighbours(page.p.predicted.surface), page.p.target,
                             page.p.predicted.rgb, edge_terms(page.p.predicted.surface, page.p.target, page.p.target));
    };
    CHECK(unevenness([](int, int, bool) { return 0.8f; }) < 1e-3);
    // Nor is a shade that fades over the page a fleck.
    CHECK(unevenness([](int x, int, bool) { return 0.7f + 0.3f * float(x) / 200; }) < 0.2);
    const auto flecked = [](float by) {
        return [by](int x, int y, bool) {
            return 0.85f + by * float(RandomStream(3, std::uint64_t(x / 2 * 100 + y / 2)).uniform() - 0.5);
        };
    };
    CHECK(unevenness(flecked(0.02f)) < flecked_above);
    CHECK(unevenness(flecked(0.2f)) > flecked_above);
}

TEST_CASE("What light does at the edges of a letter is no fleck, and flecks beside it are") {
    // A large letter's stem, 1.3 mm wide, as light leaves it that goes 0.2 mm far.
    const Page sharp([](int x, int y) { return x >= 50 && x < 63 && y >= 40 && y < 55; },
                     [](int, int, bool black) { return black ? 0.05f : 1.0f; });
    const optics::Surface& surface = sharp.p.predicted.surface;
    const halftone::EyeFilter light(surface, 0.2 / std::tan(0.0283 * 3.14159265358979323846 / 180),
                                    halftone::EyeSurround::none, halftone::OpponentSpace::cielab,
                                    halftone::EyeParts::narrowest);
    std::vector<Eigen::Vector3f> print = light.smoothed(sharp.p.target);
    const auto edges = edge_terms(surface, sharp.p.target, sharp.p.target);
    const std::vector<EdgeTerms> none(edges.size(), EdgeTerms::Zero());
    const halftone::CellNeighbours cells(surface);
    const auto& paper = sharp.p.seen.regions[0];
    REQUIRE(paper.kind == halftone::RegionKind::paper);
    const auto& stem = sharp.p.seen.regions.at(1);
    const double before = unevenness_of(stem, cells, sharp.p.target, print, none);
    CHECK(before > spoilt_above);
    CHECK(unevenness_of(stem, cells, sharp.p.target, print, edges) < 0.3 * before);
    for (std::size_t i = 0; i < print.size(); ++i)
        print[i] *= 1 - 0.2f * float(RandomStream(5, std::uint64_t(i / 3)).uniform());
    CHECK(unevenness_of(paper, cells, sharp.p.target, print, edges) > flecked_above);
}

TEST_CASE("What a larger print comes to never rises with its size, and never falls below what resins reach") {
    const MeanParts mean{.reach = 0.8, .thin = 2, .flat = 0.5, .neighbours = 3, .wall_mm = 0.5, .thick_walls = 0.4};
    double before = mean_when_larger(mean, 1, 0.7, 2);
    CHECK(before == Approx(mean.sum()));
    for (double k = 1.1; k < 10; k *= 1.1) {
        const double now = mean_when_larger(mean, k, 0.7, 2);
        CHECK(now <= before);
        CHECK(now >= mean.reach + mean.flat);
        before = now;
    }
    CHECK(mean_when_larger(mean, 4, 1, 2) == Approx(0.8 + 0.5 + 0.1 + 0.75));  // walls are thick then
    const MeanParts all_thin{.reach = 0.8, .thin = 2, .neighbours = 0, .wall_mm = 0.5, .thick_walls = 2};
    CHECK(mean_when_larger(all_thin, 4, 1, 2) == Approx(0.8));
    // Light that fades in walls falls faster than their share of the depth, and no slower.
    for (const double k : {1.2, 2.0, 6.0})
        CHECK(mean_when_larger(mean, k, 0.7, 2, 0.3) <= mean_when_larger(mean, k, 0.7, 2));
    CHECK(mean_when_larger(all_thin, 2, 1, 2, 0.3) == Approx(0.8 + 2 * std::exp(-0.5 / 0.3)));
}

TEST_CASE("What a longer loop comes to goes on from its last gains") {
    CHECK(mean_of_longer_loop({5}, 9) == 5);
    CHECK(mean_of_longer_loop({8, 4}, 0) == 4);
    CHECK(mean_of_longer_loop({8, 4, 2}, 2) == Approx(2 - 1 - 0.5));
    CHECK(mean_of_longer_loop({8, 4, 4.5}, 5) == 4.5);  // it gained nothing
    CHECK(mean_of_longer_loop({8, 4}, 8) > 1.8);
}

TEST_CASE("Small type is told by its ink, and not by its blurred rim") {
    const test::SetLine line("Serial 00417-B", 5, 2, 2, 0, "DejaVu Sans");
    JobPrediction p =
        test::page_of(18, 6, [&](double x, double y) { return Eigen::Vector3f::Constant(1 - 0.99f * line.at(x, y)); });
    for (Eigen::Vector3f& rgb : p.predicted.rgb) rgb = 0.2f * rgb + Eigen::Vector3f::Constant(0.8f);
    const auto type = unreadable_type(p, 300);
    REQUIRE(type);
    CHECK(p.target[type->cell].maxCoeff() < 0.3f);
}

TEST_CASE("Of lines that run together the place is of those that keep least") {
    const auto lines = [](int x, int y) { return y >= 30 && y < 50 && x % 8 < 2 && (x / 8 == 2 || x / 8 > 12); };
    Page page(lines, [](int x, int, bool black) { return black ? (x < 60 ? 0.95f : 0.6f) : 1.0f; });
    page.p.cell_um = {1e3 * voxel_mm, 1e3 * voxel_mm, 1e3 * voxel_mm};
    const auto lost = lost_lines(page.p);
    REQUIRE(lost);
    CHECK(page.p.predicted.surface.cells[lost->worst].cell[0] < 60);
}

TEST_CASE("How a colour differs is said by what differs most") {
    CHECK(shift_word({50, 0, 0}, {40, 3, 0}) == "darker");
    CHECK(shift_word({50, 0, 0}, {60, 3, -4}) == "lighter");
    CHECK(shift_word({50, 0, 0}, {50.5, 0.2, 0}) == "lighter");
    CHECK(shift_word({50, 0, 0}, {49.5, 0.2, 0}) == "darker");
    CHECK(shift_word({50, 30, 40}, {52, 18, 24}) == "greyer");
    CHECK(shift_word({50, 18, 24}, {52, 30, 40}) == "stronger");
    CHECK(shift_word({50, 40, 0}, {48, 38, 14}) == "yellower");
    CHECK(shift_word({50, 40, 0}, {48, 38, -14}) == "bluer");
    CHECK(shift_word({50, 0, 40}, {52, 14, 38}) == "redder");
    CHECK(shift_word({50, 0, 40}, {52, -14, 38}) == "greener");
}

TEST_CASE("A tint is told from white and grey") {
    const auto word = [](int red, int green, int blue) {
        const auto linear = [](int code) { return float(optics::srgb_decode(code / 255.0)); };
        return colour_word({linear(red), linear(green), linear(blue)});
    };
    CHECK(word(255, 255, 255) == "white");
    CHECK(word(253, 254, 255) == "white");
    CHECK(word(233, 243, 255) == "bluish white");
    CHECK(word(255, 238, 230) == "yellowish white");
    CHECK(word(255, 232, 238) == "pinkish white");
    CHECK(word(250, 248, 235) == "yellowish white");
    CHECK(word(128, 128, 128) == "grey");
    CHECK(word(118, 130, 120) == "greenish grey");
    CHECK(word(135, 112, 88) == "brown");
    CHECK(word(232, 215, 190) == "beige");
    CHECK(word(250, 160, 60) == "orange");
    // By names that CSS Color 4 gives them, where that is one of the words.
    CHECK(word(0, 0, 0) == "black");
    CHECK(word(255, 0, 0) == "red");
    CHECK(word(0, 0, 255) == "blue");
    CHECK(word(255, 255, 0) == "yellow");
    CHECK(word(128, 128, 0) == "yellow");  // as light as L* 52
    CHECK(word(85, 85, 0) == "olive");
    CHECK(word(85, 107, 47) == "green");  // "dark olive green"
    CHECK(word(0, 128, 0) == "green");
    CHECK(word(0, 255, 255) == "cyan");
    CHECK(word(139, 69, 19) == "brown");
    CHECK(word(165, 42, 42) == "red");
    CHECK(word(255, 140, 0) == "orange");
    CHECK(word(245, 245, 220) != "white");
    CHECK(word(222, 184, 135) == "beige");  // "burlywood"
    CHECK(word(255, 192, 203) == "pink");
    CHECK(word(199, 21, 133) == "magenta");
    CHECK(word(128, 0, 128) == "purple");
    CHECK(word(75, 0, 130) == "purple");  // "indigo"
    CHECK(word(190, 190, 190) == "light grey");
    CHECK(word(70, 70, 70) == "dark grey");
}

TEST_CASE("A patch that hardly differs from its paper in lightness is no fine detail that is lost") {
    const Eigen::Vector3f paper(0.956f, 0.831f, 0.791f), patch(0.871f, 0.716f, 0.578f);
    const auto paint = [&](const Eigen::Vector3f& colour) {
        return [&, colour](double x, double y) -> Eigen::Vector3f {
            return std::abs(x - 2) < 0.8 && std::abs(y - 2) < 0.85 ? colour : paper;
        };
    };
    const auto printed_paler = [&](const Eigen::Vector3f& colour) {
        JobPrediction p = test::page_of(4, 4, paint(colour));
        for (Eigen::Vector3f& rgb : p.predicted.rgb) rgb = paper + 0.3f * (rgb - paper);
        return lost_lines(p).has_value();
    };
    CHECK_FALSE(printed_paler(patch));
}

TEST_CASE("Black is looked at in a room, whose light lies over what was asked for, too") {
    const auto off = [](float asked, float printed) {
        JobPrediction p = test::page_of(4, 4, [&](double, double) { return Eigen::Vector3f(asked, asked, asked); });
        for (Eigen::Vector3f& rgb : p.predicted.rgb) rgb.setConstant(printed);
        return seen_from(p, 300, false).difference.front();
    };
    const auto by_codes = [](double a, double b) {
        return optics::ciede2000(optics::lab_from_linear_srgb(Eigen::Vector3d::Constant(a)),
                                 optics::lab_from_linear_srgb(Eigen::Vector3d::Constant(b)));
    };
    // 1 % over both, so that white stays white.
    CHECK(off(0, 0.005f) == Approx(by_codes(0.01 / 1.01, 0.015 / 1.01)).epsilon(1e-3));
    CHECK(off(0, 0.005f) < 0.9 * by_codes(0, 0.005));
    CHECK(off(1, 0.8f) == Approx(by_codes(1, 0.81 / 1.01)).epsilon(1e-3));
}

TEST_CASE("A place is told by the name that somebody gave it, and not by a number") {
    const auto at_top = [](const std::string& name) {
        RoofedCube cube;
        io::TexturedMesh& mesh = cube.body.model.mesh;
        mesh.triangles.resize(4);
        mesh.material_of_triangle = {0, 1, 1, 1};
        mesh.materials.resize(2);
        mesh.materials[0].name = name, mesh.materials[1].name = "Body";
        return PlaceWords(cube.body).at({3, 2, 4});
    };
    CHECK(at_top("Roof") == "upper right, on 'Roof'");
    for (const char* number : {"4700acf5024d4a4ca7e5edd0aa6f6fd5", "12", "{0b8e-11}"})
        CHECK(at_top(number) == "upper right");
    for (const std::string name : {"Face", "Bed2", "F-16"}) CHECK(at_top(name) == "upper right, on '" + name + "'");
}
