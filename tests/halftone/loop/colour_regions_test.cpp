// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/colour_regions.h"

#include <catch2/catch.hpp>

#include <functional>

#include "base/random.h"
#include "flat_surface.h"
#include "halftone/loop/loop_measure.h"
#include "halftone/loop/paper.h"
#include "optics/colour/colour.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int n = 120;
constexpr double cell_mm = 0.085;
using Colours = std::vector<Eigen::Vector3f>;

Colours painted(const std::function<Eigen::Vector3f(int x, int y)>& paint) {
    Colours rgb;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) rgb.push_back(paint(x, y));
    return rgb;
}

const Eigen::Vector3f white(1, 1, 1), red(0.7f, 0.02f, 0.03f), black(0.01f, 0.01f, 0.01f);

bool in_square(int x, int y) { return x >= 10 && x < 50 && y >= 10 && y < 50; }
// Strokes of three cells.
bool in_stroke(int x, int y) { return x >= 70 && x < 110 && y % 12 < 3 && y >= 24 && y < 96; }

// A red square and black strokes on white, with edges that are blurred as cells see them.
Colours card() {
    return painted([](int x, int y) -> Eigen::Vector3f {
        if (in_square(x, y)) return x == 10 ? Eigen::Vector3f(0.5f * (white + red)) : red;
        return in_stroke(x, y) ? black : white;
    });
}

}  // namespace

TEST_CASE("A card has paper, a solid and strokes, blurred edges are none of them", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const std::vector<ColourRegion> regions = colour_regions(surface, card());
    REQUIRE(regions.size() == 3);
    CHECK(regions[0].kind == RegionKind::paper);
    CHECK(regions[1].kind == RegionKind::solid);
    CHECK((regions[1].target - red).norm() < 1e-4f);
    CHECK(regions[1].cells.size() == 39 * 40);
    CHECK(regions[1].area_mm2 == Approx(39 * 40 * cell_mm * cell_mm).epsilon(1e-4));
    // 0.6 mm are seven cells.
    CHECK(regions[1].interior.size() == (39 - 14) * (40 - 14));
    CHECK(regions[2].kind == RegionKind::strokes);
    CHECK(regions[2].cells.size() == 6 * 3 * 40);
    CHECK(CellNeighbours(surface).around(regions[1], 1).size() == 41 * 42 - 39 * 40);
}

TEST_CASE("The blurred edge of a long stripe is no region, a long hairline is one", "[loop]") {
    constexpr int width = 60, height = 200;
    Colours flag;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            flag.push_back(x < 20 || x > 50 ? red
                           : x == 20        ? Eigen::Vector3f(0.3f * red + 0.7f * white)
                           : x == 40        ? Eigen::Vector3f(0.4f * white)
                                            : white);
    const std::vector<ColourRegion> regions = colour_regions(test::flat_surface(width, height, cell_mm), flag);
    REQUIRE(regions.size() == 4);
    CHECK(regions[0].kind == RegionKind::paper);
    CHECK(regions[1].cells.size() == 20 * height);
    CHECK(regions[2].cells.size() == 9 * height);
    CHECK(regions[3].cells.size() == height);
    CHECK((regions[3].target - 0.4f * white).norm() < 1e-4f);
}

TEST_CASE("What photographs hold is no region", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const auto noise = [](int x, int y) {
        return 0.02f * static_cast<float>(RandomStream(1, static_cast<std::uint64_t>(y * n + x)).uniform());
    };
    CHECK(colour_regions(surface,
                         painted([&](int x, int y) { return Eigen::Vector3f::Constant(0.2f + noise(x, y)).eval(); }))
              .empty());
    // A sky: flat for millimetres, without an edge.
    CHECK(colour_regions(surface, painted([](int x, int y) {
                             return Eigen::Vector3f(0.2f, 0.3f + 0.001f * static_cast<float>(x),
                                                    0.5f + 0.001f * static_cast<float>(y));
                         }))
              .empty());
}

TEST_CASE("A region is judged by its mean and by its evenness", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const Colours target = card();
    const std::vector<ColourRegion> regions = colour_regions(surface, target);
    const auto look = [&](const Colours& print) { return look_at(regions, surface, target, print)[1]; };
    const RegionLook same = look(target);
    CHECK(same.difference == Approx(0).margin(1e-6));
    CHECK(same.unevenness == Approx(0).margin(1e-3));
    const auto changed = [&](const std::function<float(int x)>& factor) {
        Colours print = target;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) print[static_cast<std::size_t>(y * n + x)] *= factor(x);
        return look(print);
    };
    const RegionLook lighter = changed([](int) { return 1.3f; }),
                     striped = changed([](int x) { return x / 5 % 2 ? 1.3f : 0.7f; });
    CHECK(lighter.difference > 3);
    CHECK(lighter.unevenness < 0.1);
    CHECK(striped.difference < 1);
    CHECK(striped.unevenness > 5);
    CHECK(worse_by(lighter, same) ==
          Approx(lighter.difference - same.difference + 2 * lighter.unevenness).margin(0.01));
    CHECK(worse_by(same, striped) == 0);
}

TEST_CASE("Paper is white that there is much of, its level is what a person adapts to", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const auto level = [&](int columns_of_paper) {
        const Colours target = painted([&](int x, int) { return x < columns_of_paper ? white : black; });
        Colours print = target;
        for (Eigen::Vector3f& rgb : print) rgb *= 0.8f;
        return paper_level(surface, target, print);
    };
    CHECK(level(0) == 1);
    CHECK(level(n) == Approx(1 - 0.85 * 0.2 / 1.01).epsilon(1e-4));
    CHECK(level(n / 10) == Approx(1 - 0.85 * 0.2 / 2).epsilon(1e-3));
    CHECK(level(2) > 0.99);
}

TEST_CASE("Cream is paper, light yellow is a colour, and a tinted page in its own colour is at its level", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const auto of = [](double r, double g, double b) {
        const auto linear = [](double code) { return static_cast<float>(optics::srgb_decode(code / 255)); };
        return Eigen::Vector3f(linear(r), linear(g), linear(b));
    };
    const Eigen::Vector3f cream = of(250, 246, 235), yellow = of(255, 255, 160);
    CHECK(paper_weight(white) == 1);
    CHECK(paper_weight(cream) > 0.7f);
    CHECK(paper_weight(yellow) == 0);
    CHECK(paper_weight(black) == 0);
    // A square of white on it, whose letters darken it, is not the page: the cream around it is as light as asked.
    const Colours target = painted([&](int x, int) { return x < n / 4 ? white : cream; });
    Colours print = target;
    CHECK(paper_level(surface, target, print) == Approx(1));
    for (std::size_t i = 0; i < print.size(); ++i)
        if (target[i] == white) print[i] *= 0.6f;
    CHECK(paper_level(surface, target, print) > 0.89f);
}

TEST_CASE("The measure forgives darker paper, and no solid that is worse than without a loop", "[loop][slow]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const Colours target = card();
    const std::vector<char> in(target.size(), 1);
    const LoopMeasure measure(surface, target, target, in, 300);
    Colours darker = target;
    for (Eigen::Vector3f& rgb : darker) rgb *= 0.8f;
    const LoopMeasure::Value open = measure(target, {}), dimmed = measure(darker, open.looks);
    CHECK(open.score < 0.01);
    CHECK(dimmed.paper == Approx(1 - 0.85 * 0.2).epsilon(0.02));
    CHECK(dimmed.seen.mean < 1.5);
    const LoopMeasure absolute(surface, target, target, in, 300, false);
    CHECK(absolute(darker, {}).paper == 1);
    CHECK(absolute(darker, {}).seen.mean > 4);
    // The square alone, by as much: less of the surface, and seen.
    Colours worse = target;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            if (in_square(x, y)) worse[static_cast<std::size_t>(y * n + x)] *= 0.8f;
    const LoopMeasure::Value punished = measure(worse, open.looks), alone = measure(worse, {});
    CHECK(punished.seen.mean < dimmed.seen.mean);
    CHECK(punished.score > 1.8 * alone.score);
    CHECK(alone.score > 1.5 * alone.seen.mean);
}

TEST_CASE("A print that is as the open loop was, or a little worse in a region, is scored as without regions",
          "[loop]") {
    constexpr int small = 60;
    const optics::Surface surface = test::flat_surface(small, small, cell_mm);
    const auto square = [](int x, int y) { return x >= 12 && x < 44 && y >= 12 && y < 44; };
    const auto print = [&](float of_square) {
        Colours rgb;
        for (int y = 0; y < small; ++y)
            for (int x = 0; x < small; ++x) rgb.push_back(square(x, y) ? Eigen::Vector3f(of_square * red) : white);
        return rgb;
    };
    const Colours target = print(1);
    const std::vector<char> in(target.size(), 1);
    const LoopMeasure measure(surface, target, target, in, 300);
    REQUIRE(measure.regions().size() == 2);
    const auto open = measure(print(0.9f), {});
    CHECK((open.score > 0 && open.seen.mean > 0 && open.cells.mean > 0));
    // No better than without a loop, and no worse.
    CHECK(measure(print(0.9f), open.looks).score == open.score);
    CHECK(measure(print(0.95f), open.looks).score == measure(print(0.95f), {}).score);
    // Much worse: by the region's own error besides, and the more the worse.
    const double bad = measure(print(0.6f), open.looks).score, bad_alone = measure(print(0.6f), {}).score;
    CHECK(bad > 1.2 * bad_alone);
    CHECK(measure(print(0.5f), open.looks).score - measure(print(0.5f), {}).score > bad - bad_alone);
}

TEST_CASE("Cells of a body touch on all sides, whichever of them comes first", "[loop]") {
    // In order of z, y, x: the first lies neither lowest nor highest along y, and rows have gaps.
    optics::Surface surface;
    for (const std::array<std::int32_t, 3>& at : std::vector<std::array<std::int32_t, 3>>{
             {5, 4, 2}, {6, 4, 2}, {5, 2, 3}, {4, 3, 3}, {7, 3, 3}, {6, 5, 3}, {5, 3, 4}, {5, 6, 4}}) {
        surface.cells.emplace_back();
        surface.cells.back().cell = at, surface.cells.back().normal = {0, 0, 1};
    }
    const CellNeighbours neighbours(surface);
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        std::vector<std::size_t> found, touching;
        neighbours.visit_around(i, [&](std::size_t cell) { found.push_back(cell); });
        for (std::size_t j = 0; j < surface.cells.size(); ++j) {
            int steps = 0;
            for (std::size_t a = 0; a < 3; ++a)
                steps = std::max(steps, std::abs(surface.cells[i].cell[a] - surface.cells[j].cell[a]));
            if (steps <= 1) touching.push_back(j);
        }
        INFO("cell " << i);
        CHECK(found == touching);
    }
    ColourRegion first;
    first.cells = {0};
    CHECK(neighbours.around(first, 1) == std::vector<std::uint32_t>{1, 3, 5});
    CHECK(neighbours.around(first, 2) == std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6, 7});
}

TEST_CASE("A rim of another hue is told, a darker one is not", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const Colours target = card();
    const ColourRegion red_square = colour_regions(surface, target)[1];
    const CellNeighbours cells(surface);
    const auto with_rim = [&](const Eigen::Vector3f& factor) {
        Colours print = target;
        for (int y = 3; y < 57; ++y)
            for (int x = 3; x < 57; ++x)
                if (!in_square(x, y)) {
                    Eigen::Vector3f& rgb = print[static_cast<std::size_t>(y * n + x)];
                    rgb = rgb.cwiseProduct(factor);
                }
        return rim_chroma(red_square, cells, target, print);
    };
    CHECK(with_rim({1, 1, 1}) == Approx(0).margin(1e-6));
    CHECK(with_rim({0.8f, 0.8f, 0.8f}) < 0.5);
    CHECK(with_rim({1, 1, 0.6f}) > 10);
    // What lies farther off than 0.6 mm is no rim.
    Colours far = target;
    for (int y = 0; y < n; ++y) far[static_cast<std::size_t>(y * n + 65)] = {1, 1, 0};
    CHECK(rim_chroma(red_square, cells, target, far) == Approx(0).margin(1e-6));
}

TEST_CASE("A letter of two cells' width is a stroke like its wider neighbours", "[loop]") {
    // Left alone it was nobody's, and the descent made it yellow for its neighbours' sake.
    const optics::Surface surface = test::flat_surface(n, n, cell_mm);
    const auto in_letter = [](int x, int y) { return x >= 60 && x < 62 && y >= 10 && y < 40; };
    const Colours page =
        painted([&](int x, int y) -> Eigen::Vector3f { return in_stroke(x, y) || in_letter(x, y) ? black : white; });
    const std::vector<ColourRegion> regions = colour_regions(surface, page);
    REQUIRE(regions.size() == 2);
    CHECK(regions[1].kind == RegionKind::strokes);
    CHECK(regions[1].cells.size() == 6 * 3 * 40 + 2 * 30);
}
