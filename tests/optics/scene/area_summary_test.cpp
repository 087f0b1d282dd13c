// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/area_summary.h"

#include <array>

#include <catch2/catch.hpp>

using namespace voxtone::optics;

namespace {

Surface cells_of(const std::vector<float>& areas_mm2) {
    Surface surface;
    for (const float area : areas_mm2) {
        surface.cells.emplace_back();
        surface.cells.back().area_mm2 = area;
    }
    return surface;
}

}  // namespace

TEST_CASE("Differences over a surface weigh with the areas of their cells", "[surface]") {
    const Surface cells = cells_of({1, 5, 2, 2});
    const std::array<double, 4> differences{8, 1, 3, 2};
    const DifferenceSummary all = summarize_by_area(cells, differences);
    CHECK(all.count == 4);
    CHECK(all.mean == Approx((8 + 5 + 6 + 4) / 10.0));
    CHECK(all.max == 8);
    CHECK(all.median == 1);  // of half of the area, exactly
    CHECK(all.percentile_95 == 8);
    // The least area more beyond a half, and the next difference is the median; nine tenths and a half are below 95 %.
    CHECK(summarize_by_area(cells_of({1, 4.9f, 2, 2}), differences).median == 2);
    CHECK(summarize_by_area(cells_of({0.4f, 5, 2, 2}), differences).percentile_95 == 3);
}

TEST_CASE("Cells that do not count are left out of all figures", "[surface]") {
    const Surface cells = cells_of({1, 5, 2, 2});
    const std::array<double, 4> differences{8, 1, 3, 2};
    const std::array<char, 4> counts{0, 0, 1, 1};
    const DifferenceSummary two = summarize_by_area(cells, differences, counts);
    CHECK(two.count == 2);
    CHECK(two.mean == 2.5);
    CHECK(two.max == 3);
    CHECK(two.median == 2);
    const DifferenceSummary none = summarize_by_area(cells, differences, std::array<char, 4>{});
    CHECK(none.count == 0);
    CHECK(none.mean == 0);
    CHECK(none.max == 0);
}
