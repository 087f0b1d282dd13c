// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/widening_targets.h"

#include <catch2/catch.hpp>

using namespace voxtone::scattering;

TEST_CASE("Widening targets keep the lesser total of each channel and go in even steps from one shape to the other") {
    const ChannelProfiles narrow{{0.8, 0.4}, {0.2, 0.1}}, wide{{0.4, 0.1}, {0.5, 0.05}};
    const auto targets = widening_targets(narrow, wide, 3);
    REQUIRE(targets.size() == 3);
    for (const ChannelProfiles& target : targets) {
        CHECK(target[0][0] == Approx(0.4));
        CHECK(target[1][0] == Approx(0.2));
    }
    CHECK(targets[0][0][1] == Approx(0.2));   // half of its total, as in the narrow one
    CHECK(targets[2][0][1] == Approx(0.1));   // a quarter, as in the wide one
    CHECK(targets[1][0][1] == Approx(0.15));  // amid them
    CHECK(targets[0][1][1] == Approx(0.1));
    CHECK(targets[2][1][1] == Approx(0.02));
    CHECK(widening_targets(narrow, wide, 1)[0][0][1] == Approx(0.2));
}
