// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/nesting.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

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
int least_gap(const std::vector<Outline>& outlines, const std::vector<std::optional<std::array<int, 2>>>& at) {
    int least = 1 << 20;
    for (std::size_t a = 0; a < outlines.size(); ++a)
        for (std::size_t b = a + 1; b < outlines.size(); ++b)
            for (int y = 0; y < outlines[a].height(); ++y)
                for (int x = 0; x < outlines[a].width(); ++x) {
                    if (!outlines[a].at(x, y)) continue;
                    for (int v = 0; v < outlines[b].height(); ++v)
                        for (int u = 0; u < outlines[b].width(); ++u)
                            if (outlines[b].at(u, v))
                                least = std::min(least, std::max(std::abs(x + (*at[a])[0] - u - (*at[b])[0]),
                                                                 std::abs(y + (*at[a])[1] - v - (*at[b])[1])) -
                                                            1);
                }
    return least;
}

int columns_used(const std::vector<Outline>& outlines, const std::vector<std::optional<std::array<int, 2>>>& at) {
    int most = 0;
    for (std::size_t p = 0; p < outlines.size(); ++p) most = std::max(most, (*at[p])[0] + outlines[p].width());
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
    const auto at = nest(outlines, {160, 40}, gap);
    for (std::size_t p = 0; p < outlines.size(); ++p) {
        REQUIRE(at[p]);
        CHECK((*at[p])[0] >= 0);
        CHECK((*at[p])[1] >= 0);
        CHECK((*at[p])[0] + outlines[p].width() <= 160);
        CHECK((*at[p])[1] + outlines[p].height() <= 40);
    }
    CHECK(least_gap(outlines, at) >= gap);
    CHECK(least_gap(outlines, at) <= gap + 1);  // no room is given away
}

TEST_CASE("A plate that boxes fill to the last cell is filled") {
    const std::vector<Outline> outlines(12, box(10, 10));
    for (const auto& at : nest(outlines, {40, 30}, 0)) CHECK(at);
    const auto one_too_many = nest(std::vector<Outline>(13, box(10, 10)), {40, 30}, 0);
    CHECK(std::ranges::count_if(one_too_many, [](const auto& place) { return !place; }) == 1);
    CHECK_FALSE(nest({box(41, 3)}, {40, 30}, 0)[0]);
}

TEST_CASE("Outlines lie nearer than their boxes would") {
    std::vector<Outline> outlines, boxes;
    for (int n = 0; n < 10; ++n) {
        outlines.push_back(triangle(20, n % 2));
        boxes.push_back(box(20, 20));
    }
    const int nested = columns_used(outlines, nest(outlines, {400, 20}, 1)),
              boxed = columns_used(boxes, nest(boxes, {400, 20}, 1));
    CHECK(boxed == 10 * 20 + 9);
    CHECK(nested < 0.85 * boxed);
}

TEST_CASE("What is on the plate already stays free of others") {
    Outline taken(50, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 30; ++x) taken.set(x, y);
    const auto at = nest({box(10, 10), box(10, 10), box(5, 5)}, {50, 20}, 2, taken);
    REQUIRE(at[0]);
    CHECK((*at[0])[0] >= 32);
    CHECK_FALSE(at[1]);  // 10 + 2 + 10 do not stand in 20
    CHECK(at[2]);
}
