// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/shortened_laminate.h"

#include <catch2/catch.hpp>

#include "resin_layers.h"

using namespace voxtone;
using namespace voxtone::scattering;

TEST_CASE("A laminate is shortened to what light reaches, and no further than allowed") {
    const std::vector<LaminateMaterial> materials = resin_layers(2, 1, 24);  // white and black
    const std::vector<LaminateLayer> deep{{1, 0.02}, {0, 20}, {1, 3}, {0, 1}};
    const ChannelProfiles wanted = laminate_reflection(materials, deep, {});
    const auto distance = [&](std::span<const LaminateLayer> layers) {
        return profile_distance(laminate_reflection(materials, layers, {}), wanted, 1);
    };
    const std::vector<LaminateLayer> shorter = shortened_laminate(deep, 1e-3, distance);
    REQUIRE(shorter.size() == 2);
    CHECK(shorter[0].thickness_mm == 0.02);
    CHECK(shorter[1].material == 0);
    CHECK(shorter[1].thickness_mm < 10);
    CHECK(distance(shorter) <= 1e-3);
    std::vector<LaminateLayer> thinner = shorter;
    thinner[1].thickness_mm -= 20.0 / 1000;
    CHECK(distance(thinner) > 1e-3);

    CHECK(shortened_laminate(deep, -1, distance).size() == 4);
    CHECK(shortened_laminate(deep, 10, distance).empty());
    CHECK(shortened_laminate({}, 10, distance).empty());
}
