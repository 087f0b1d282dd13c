// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.h"

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;

TEST_CASE("Lengths are read with and without units") {
    CHECK(parse_length_mm("60", "--size") == 60);
    CHECK(parse_length_mm("60mm", "--size") == 60);
    CHECK(parse_length_mm(" 6 cm ", "--size") == 60);
    CHECK(parse_length_mm("2.5in", "--size") == 63.5);
    CHECK(parse_length_mm("85um", "--size") == Approx(0.085));
    CHECK(parse_length_mm("-1", "--x") == -1);
}

TEST_CASE("A length that cannot be read names the option and the known units") {
    for (const char* bad : {"", "mm", "1e999", "nan", "inf", "6 parsec", "6mm7"}) {
        INFO(bad);
        try {
            (void)parse_length_mm(bad, "--size");
            FAIL("accepted");
        } catch (const UsageError& error) {
            CHECK_THAT(error.what(), Catch::Matchers::Contains("--size"));
        }
    }
}
