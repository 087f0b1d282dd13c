// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/job_layers.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::scattering;

TEST_CASE("By itself a map is traced where it is of few clusters and its profiles are no means over its pixels") {
    io::ProfileMap map;
    map.width_px = 10, map.width_mm = 5;
    map.target.assign(16, {{0.1, {1, 1, 1, 1}, {}}});
    slicer::LayeredOptions options;
    CHECK(traced_rounds(options, map) == 1);
    map.target[0][0].spacing_mm = 0.5;  // a pixel
    CHECK(traced_rounds(options, map) == 0);
    options.rounds = 2;
    CHECK(traced_rounds(options, map) == 2);
    options.rounds.reset();
    map.target.assign(17, {{0.1, {1, 1, 1, 1}, {}}});
    CHECK(traced_rounds(options, map) == 0);
    map.target.resize(3);
    options.materials = {{"W", "white.json"}};
    CHECK(traced_rounds(options, map) == 0);
}
