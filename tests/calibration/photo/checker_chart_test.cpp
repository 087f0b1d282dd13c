// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/checker_chart.h"

#include <fstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "tests/places.h"

using namespace voxtone::calibration;

TEST_CASE("the colour checker in the program is the reference's") {
    // tests/data/reference/colorchecker24.json: linear sRGB computed elsewhere from the same CIELAB values.
    const nlohmann::json reference =
        nlohmann::json::parse(std::ifstream(voxtone::test::test_data() + "/reference/colorchecker24.json"));
    const CheckerChart chart = find_checker("colorchecker24");
    REQUIRE(chart.linear_srgb.size() == 24);
    CHECK(chart.columns == 6);
    for (std::size_t p = 0; p < 24; ++p)
        for (int channel = 0; channel < 3; ++channel)
            CHECK(chart.linear_srgb[p][channel] ==
                  Approx(reference["patches"][p]["srgb_linear_after_nov2014"][std::size_t(channel)].get<double>())
                      .margin(2e-5));
}

TEST_CASE("an unknown checker is refused with the names there are") {
    CHECK_THROWS_WITH(find_checker("colorchecker42"), Catch::Contains("colorchecker24"));
}
