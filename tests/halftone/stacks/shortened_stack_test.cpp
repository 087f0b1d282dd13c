// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/stacks/shortened_stack.h"

#include <catch2/catch.hpp>

#include "resin_layers.h"

using namespace voxtone;
using namespace voxtone::halftone;

TEST_CASE("A stack is shortened to what light reaches, and no further than allowed") {
    const std::vector<StackMaterial> materials = resin_layers(2, 1, 24);  // white and black
    const std::vector<StackLayer> deep{{1, 0.02}, {0, 20}, {1, 3}, {0, 1}};
    const ChannelProfiles wanted = stack_reflection(materials, deep, {});
    const auto distance = [&](std::span<const StackLayer> layers) {
        return profile_distance(stack_reflection(materials, layers, {}), wanted, 1);
    };
    const std::vector<StackLayer> shorter = shortened_stack(deep, 1e-3, distance);
    REQUIRE(shorter.size() == 2);
    CHECK(shorter[0].thickness_mm == 0.02);
    CHECK(shorter[1].material == 0);
    CHECK(shorter[1].thickness_mm < 10);
    CHECK(distance(shorter) <= 1e-3);
    std::vector<StackLayer> thinner = shorter;
    thinner[1].thickness_mm -= 20.0 / 1000;
    CHECK(distance(thinner) > 1e-3);

    CHECK(shortened_stack(deep, -1, distance).size() == 4);
    CHECK(shortened_stack(deep, 10, distance).empty());
    CHECK(shortened_stack({}, 10, distance).empty());
}
