// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/pass_bands.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

using Places = std::vector<std::optional<NestPlace>>;

Outline box(int width, int height) {
    Outline outline(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) outline.set(x, y);
    return outline;
}

NestItem item_of(const Outline& outline, std::size_t group) { return {{outline}, group}; }

/// Cells from the lowest to the highest that any part takes along an axis.
int extent(const std::vector<NestItem>& items, const Places& places, int axis) {
    int low = 1 << 20, high = 0;
    for (std::size_t n = 0; n < items.size(); ++n) {
        const Outline& outline = items[n].turns[std::size_t(places[n]->turn)];
        const int begin = axis == 0 ? places[n]->x : places[n]->y;
        low = std::min(low, begin);
        high = std::max(high, begin + (axis == 0 ? outline.width() : outline.height()));
    }
    return high - low;
}

int strips(int cells, int width) { return (cells + width - 1) / width; }

bool all_placed(const Places& places) {
    return std::ranges::all_of(places, [](const auto& place) { return place.has_value(); });
}

/// Boxes with less than the gap between them, or off the plate.
bool is_sound(const std::vector<NestItem>& items, const Places& places, const std::array<int, 2>& plate, int gap) {
    for (std::size_t a = 0; a < items.size(); ++a) {
        const Outline& one = items[a].turns[0];
        if (places[a]->x < 0 || places[a]->y < 0) return false;
        if (places[a]->x + one.width() > plate[0] || places[a]->y + one.height() > plate[1]) return false;
        for (std::size_t b = 0; b < a; ++b) {
            const Outline& other = items[b].turns[0];
            const int x =
                std::max(places[b]->x - places[a]->x - one.width(), places[a]->x - places[b]->x - other.width());
            const int y =
                std::max(places[b]->y - places[a]->y - one.height(), places[a]->y - places[b]->y - other.height());
            if (std::max(x, y) < gap) return false;
        }
    }
    return true;
}

constexpr std::array plate{980, 780};  // the J750's, in half millimetres
constexpr int strip = 100, gap = 4;

}  // namespace

TEST_CASE("Fifteen small parts lie in one pass along the heads' way, whichever axis that is") {
    std::vector<NestItem> items;
    for (std::size_t n = 0; n < 15; ++n) items.push_back(item_of(box(50, 18 + int(n)), n));
    for (const int along : {0, 1}) {
        CAPTURE(along);
        const Places places = nest_in_passes(items, plate, gap, std::nullopt, {along, strip});
        REQUIRE(all_placed(places));
        CHECK(is_sound(items, places, plate, gap));
        CHECK(strips(extent(items, places, 1 - along), strip) == 1);
        CHECK(extent(items, places, along) > 2 * strip);
    }
    // Where nothing is known of passes they stand as close as can be, over several strips.
    const Places places = nest_in_passes(items, plate, gap, std::nullopt, {});
    REQUIRE(all_placed(places));
    CHECK(strips(extent(items, places, 1), strip) > 1);
}

TEST_CASE("No layout takes more passes than the closest one along the other axis, or fewer than its areas") {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, 0);
        std::vector<NestItem> items;
        double area = 0;
        const int count = 3 + int(random.uniform() * 30);
        for (int n = 0; n < count; ++n) {
            items.push_back(
                item_of(box(10 + int(random.uniform() * 130), 10 + int(random.uniform() * 130)), items.size()));
            area += double(items.back().turns[0].area());
        }
        const Places places = nest_in_passes(items, plate, gap, std::nullopt, {0, strip});
        const Places close = nest(items, plate, gap);
        REQUIRE(all_placed(close));
        REQUIRE(all_placed(places));
        CHECK(is_sound(items, places, plate, gap));
        const int passes = strips(extent(items, places, 1), strip);
        CHECK(passes <= strips(extent(items, close, 1), strip));
        CHECK(passes >= strips(int(area / plate[0]), strip));
        int widest = 0;
        for (const NestItem& item : items) widest = std::max(widest, item.turns[0].height());
        CHECK(passes >= strips(widest, strip));
        // One strip less has no room for all, by the same nesting.
        if ((passes - 1) * strip < widest) continue;
        const Places fewer = nest(items, {plate[0], (passes - 1) * strip}, gap);
        CHECK_FALSE(all_placed(fewer));
    }
}

TEST_CASE("What lies on the plate already is in the band, and what fits into no band goes where there is room") {
    Outline taken(plate[0], plate[1]);
    for (int x = 100; x < 140; ++x)
        for (int y = 400; y < 480; ++y) taken.set(x, y);
    const std::vector<NestItem> items{item_of(box(60, 90), 0), item_of(box(60, 90), 1)};
    for (const auto& place : nest_in_passes(items, plate, gap, taken, {0, strip})) {
        REQUIRE(place);
        CHECK(place->y >= 400);
        CHECK(place->y + 90 <= 500);
        CHECK((place->x + 60 + gap <= 100 || place->x >= 140 + gap));
    }
    const std::vector<NestItem> wide{item_of(box(900, 120), 0), item_of(box(900, 700), 1)};
    const Places one = nest_in_passes(wide, plate, gap, std::nullopt, {0, strip});
    CHECK(std::ranges::count_if(one, [](const auto& place) { return place.has_value(); }) == 1);
}
