// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/nesting.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

using Places = std::vector<std::optional<NestPlace>>;

/// Each by itself, not to be turned.
Places lay_out(const std::vector<Outline>& outlines, const std::array<int, 2>& plate, int gap,
               const std::optional<Outline>& taken = std::nullopt) {
    std::vector<NestItem> items;
    for (const Outline& outline : outlines) items.push_back({{outline}, items.size()});
    return nest(items, plate, gap, taken);
}

Outline box(int width, int height) {
    Outline outline(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) outline.set(x, y);
    return outline;
}

/// Half of a square, below its diagonal or above it.
Outline triangle(int edge, bool lower) {
    Outline outline(edge, edge);
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
            if (lower ? x + y < edge : x + y >= edge) outline.set(x, y);
    return outline;
}

Outline disc(int diameter) {
    Outline outline(diameter, diameter);
    const double r = diameter / 2.0;
    for (int y = 0; y < diameter; ++y)
        for (int x = 0; x < diameter; ++x)
            if ((x + 0.5 - r) * (x + 0.5 - r) + (y + 0.5 - r) * (y + 0.5 - r) <= r * r) outline.set(x, y);
    return outline;
}

/// The least Chebyshev distance between cells of any two parts, less one: the free cells between them; -1: they
/// overlap.
int least_gap(const std::vector<Outline>& outlines, const Places& at) {
    int least = 1 << 20;
    for (std::size_t a = 0; a < outlines.size(); ++a)
        for (std::size_t b = a + 1; b < outlines.size(); ++b)
            for (int y = 0; y < outlines[a].height(); ++y)
                for (int x = 0; x < outlines[a].width(); ++x) {
                    if (!outlines[a].at(x, y)) continue;
                    for (int v = 0; v < outlines[b].height(); ++v)
                        for (int u = 0; u < outlines[b].width(); ++u)
                            if (outlines[b].at(u, v))
                                least = std::min(least, std::max(std::abs(x + at[a]->x - u - at[b]->x),
                                                                 std::abs(y + at[a]->y - v - at[b]->y)) -
                                                            1);
                }
    return least;
}

int columns_used(const std::vector<Outline>& outlines, const Places& at) {
    int most = 0;
    for (std::size_t p = 0; p < outlines.size(); ++p) most = std::max(most, at[p]->x + outlines[p].width());
    return most;
}

}  // namespace

TEST_CASE("Outlines find room with the gap between them, on the plate") {
    const int gap = GENERATE(0, 1, 3);
    CAPTURE(gap);
    RandomStream random(7, 0);
    std::vector<Outline> outlines;
    for (int n = 0; n < 14; ++n) {
        const int size = 6 + int(random.uniform() * 14);
        outlines.push_back(n % 3 == 0 ? box(size, 30 - size) : n % 3 == 1 ? disc(size) : triangle(size, n % 2));
    }
    const auto at = lay_out(outlines, {160, 40}, gap);
    for (std::size_t p = 0; p < outlines.size(); ++p) {
        REQUIRE(at[p]);
        CHECK(at[p]->x >= 0);
        CHECK(at[p]->y >= 0);
        CHECK(at[p]->x + outlines[p].width() <= 160);
        CHECK(at[p]->y + outlines[p].height() <= 40);
    }
    CHECK(least_gap(outlines, at) >= gap);
    CHECK(least_gap(outlines, at) <= gap + 1);  // no room is given away
}

TEST_CASE("A plate that boxes fill to the last cell is filled") {
    const std::vector<Outline> outlines(12, box(10, 10));
    for (const auto& at : lay_out(outlines, {40, 30}, 0)) CHECK(at);
    const auto one_too_many = lay_out(std::vector<Outline>(13, box(10, 10)), {40, 30}, 0);
    CHECK(std::ranges::count_if(one_too_many, [](const auto& place) { return !place; }) == 1);
    CHECK_FALSE(lay_out({box(41, 3)}, {40, 30}, 0)[0]);
}

TEST_CASE("Outlines lie nearer than their boxes would") {
    std::vector<Outline> outlines, boxes;
    for (int n = 0; n < 10; ++n) {
        outlines.push_back(triangle(20, n % 2));
        boxes.push_back(box(20, 20));
    }
    const int nested = columns_used(outlines, lay_out(outlines, {400, 20}, 1)),
              boxed = columns_used(boxes, lay_out(boxes, {400, 20}, 1));
    CHECK(boxed == 10 * 20 + 9);
    CHECK(nested < 0.85 * boxed);
}

TEST_CASE("What is on the plate already stays free of others") {
    Outline taken(50, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 30; ++x) taken.set(x, y);
    const auto at = lay_out({box(10, 10), box(10, 10), box(5, 5)}, {50, 20}, 2, taken);
    REQUIRE(at[0]);
    CHECK(at[0]->x >= 32);
    CHECK_FALSE(at[1]);  // 10 + 2 + 10 do not stand in 20
    CHECK(at[2]);
}

TEST_CASE("A grown outline holds what is no more cells away, along both axes") {
    const Outline outline = disc(9);
    for (const int cells : {0, 1, 3, 20}) {
        const Outline grown = outline.grown(cells);
        REQUIRE(grown.width() == 9 + 2 * cells);
        for (int x = 0; x < grown.width(); ++x)
            for (int y = 0; y < grown.height(); ++y) {
                bool near = false;
                for (int i = std::max(0, x - 2 * cells); i <= std::min(8, x); ++i)
                    for (int j = std::max(0, y - 2 * cells); j <= std::min(8, y); ++j) near |= outline.at(i, j);
                if (grown.at(x, y) != near) FAIL(cells << ": " << x << ", " << y);
            }
    }
    CHECK(box(120, 120).grown(4000).area() == std::size_t{8120} * 8120);  // a gap of 2 m, at once
}

TEST_CASE("An outline is turned counter-clockwise, and four times is none") {
    Outline outline(3, 2);
    outline.set(2, 0);
    const Outline quarter = outline.turned(1);
    CHECK(quarter.width() == 2);
    CHECK(quarter.height() == 3);
    CHECK(quarter.at(1, 2));  // the right end of the front edge comes to the far end of the right edge
    CHECK(quarter.area() == 1);
    const Outline back = outline.turned(4);
    CHECK(back.at(2, 0));
    CHECK(back.area() == 1);
}

TEST_CASE("What may be turned is turned where it lies closer so, and all of a group alike") {
    const auto bars = [](bool may_turn) {
        std::vector<NestItem> items;
        for (int n = 0; n < 4; ++n) {
            NestItem item{{box(20, 5)}, 0};
            for (int turn = 1; may_turn && turn < 4; ++turn) item.turns.push_back(item.turns[0].turned(turn));
            items.push_back(item);
        }
        return items;
    };
    const auto columns = [](const std::vector<NestItem>& items, const Places& at) {
        int most = 0;
        for (std::size_t n = 0; n < at.size(); ++n) {
            REQUIRE(at[n]);
            most = std::max(most, at[n]->x + items[n].turns[std::size_t(at[n]->turn)].width());
        }
        return most;
    };
    CHECK(columns(bars(false), nest(bars(false), {200, 12}, 0)) == 40);
    CHECK(columns(bars(true), nest(bars(true), {200, 22}, 0)) == 20);
    const Places narrow = nest(bars(true), {18, 40}, 0);
    for (const auto& place : narrow) {
        REQUIRE(place);
        CHECK(place->turn % 2 == 1);  // 20 long, they find no room otherwise
        CHECK(place->turn == narrow[0]->turn);
    }
    const Places none = nest(bars(false), {18, 40}, 0);
    for (const auto& place : none) CHECK_FALSE(place);
}

TEST_CASE("What is laid out lies as far left as it can, and there as low, on plates of any height") {
    // Columns of more cells than a word of memory has bits.
    for (std::uint64_t draw = 0; draw < 60; ++draw) {
        CAPTURE(draw);
        RandomStream random(11, draw);
        const auto below = [&](int n) { return int(random.uniform() * n); };
        const int width = 12, height = 60 + below(200), high = 1 + below(height - 1), wide = 1 + below(3);
        Outline taken(width, height), item(wide, high);
        for (int n = 0; n < 9; ++n) taken.set(below(width), below(height));
        for (int x = 0; x < wide; ++x)
            for (int from = draw % 3 == 0 ? 0 : below(high), y = from, to = from + 1 + below(high - from); y < to; ++y)
                item.set(x, y);
        const auto is_free = [&](int x, int y) {
            for (int i = 0; i < wide; ++i)
                for (int j = 0; j < high; ++j)
                    if (item.at(i, j) && taken.at(x + i, y + j)) return false;
            return true;
        };
        std::optional<NestPlace> wanted;
        for (int x = 0; x + wide <= width && !wanted; ++x)
            for (int y = 0; y + high <= height && !wanted; ++y)
                if (is_free(x, y)) wanted = NestPlace{x, y, 0};
        const auto at = lay_out({item}, {width, height}, 0, taken)[0];
        REQUIRE(at.has_value() == wanted.has_value());
        if (wanted) CHECK((at->x == wanted->x && at->y == wanted->y));
    }
}

TEST_CASE("Of many parts the tallest are laid first, or the largest, whichever leaves more room") {
    // So many that no order is tried by chance. The two kinds take the same columns in either order.
    const auto first_of = [](const Outline& given_first, std::size_t many, const Outline& last, std::size_t others,
                             int height) {
        std::vector<Outline> outlines(many, given_first);
        outlines.insert(outlines.end(), others, last);
        REQUIRE(outlines.size() > 60);
        const Places at = lay_out(outlines, {400, height}, 0);
        return at.back()->x < at.front()->x;
    };
    // One column each for the tall ones; squares lie eight on twelve columns.
    CHECK(first_of(box(12, 12), 40, box(1, 100), 21, 100));
    // Two on four columns for the large ones; the tall ones one on three.
    CHECK(first_of(box(3, 6), 31, box(4, 5), 32, 10));
}
