// SPDX-License-Identifier: GPL-3.0-or-later
//
// Against directional.json: rho(45 -> 0) of the patches of targets A and B upon bases without end, and of finite slabs.
#include "calibration/target/ideal_patch.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/calibration/photo/photo_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;

TEST_CASE("ideal patches have the reference's reflectance") {
    // tests/data/reference/directional.json, to its printed digits (README of the reference, Sec. 2).
    struct Row {
        const char *top, *backing;
        double R, G, B;
    };
    const Row rows[] = {{"W", "K", .38062, .49350, .70058}, {"K", "W", .01187, .01144, .01104},
                        {"C", "W", .00095, .06074, .46597}, {"C", "K", .00095, .04944, .33322},
                        {"M", "W", .63116, .00866, .16077}, {"M", "K", .16136, .00219, .15765},
                        {"Y", "W", .78516, .79763, .00332}, {"Y", "K", .16114, .25480, .00332},
                        {"W", "W", .80632, .88272, .79719}, {"K", "K", .01089, .01089, .01089}};
    const IdealPatches patches(optics::vero_opaque());
    for (const Row& row : rows) {
        const std::vector<double> rho = patches.reflectance({{row.top, 1.0}}, 0.675, row.backing, 0);
        CAPTURE(row.top, row.backing);
        CHECK(std::abs(rho[0] - row.R) < 1.5e-5);
        CHECK(std::abs(rho[1] - row.G) < 1.5e-5);
        CHECK(std::abs(rho[2] - row.B) < 1.5e-5);
    }
}

TEST_CASE("five millimetres of Vero white are not opaque and ten nearly are") {
    // The reference: 0.030 and 0.029 below an endless base at 5 mm, 0.0025 and 0.0033 at 10 mm, 1e-5 in blue.
    const std::vector<double> five = lost_through_base(optics::vero_opaque(), "W", 5),
                              ten = lost_through_base(optics::vero_opaque(), "W", 10);
    CHECK(five[0] == Approx(0.030).margin(6e-4));
    CHECK(five[1] == Approx(0.029).margin(6e-4));
    CHECK(five[2] < 2e-5);
    CHECK(ten[0] == Approx(0.0025).margin(6e-5));
    CHECK(ten[1] == Approx(0.0033).margin(6e-5));
    for (const double lost : lost_through_base(optics::vero_opaque(), "K", 5)) CHECK(std::abs(lost) < 1e-9);
}

TEST_CASE("a resin that a set lacks is named") {
    CHECK_THROWS_WITH(IdealPatches(optics::vero_opaque()).reflectance({{"T", 1.0}}, 0.675, "W", 0),
                      Catch::Contains("no resin T"));
}
