// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/job_layers.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::scattering;

TEST_CASE(
    "Laminates of resins are corrected in a round unless others are asked for, those of measured profiles never") {
    LayeredOptions options;
    CHECK(correcting_rounds(options) == 1);
    options.rounds = 0;
    CHECK(correcting_rounds(options) == 0);
    options.rounds = 2;
    CHECK(correcting_rounds(options) == 2);
    options.materials = {{"W", "white.json"}};
    CHECK(correcting_rounds(options) == 0);
}
