// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.h"

#include <string>
#include <utility>

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

TEST_CASE("Every unit that is known has its length, however it is written") {
    for (const auto& [unit, mm] :
         {std::pair{"um", 0.001}, std::pair{"mm", 1.0}, std::pair{"cm", 10.0}, std::pair{"m", 1000.0},
          std::pair{"in", 25.4}, std::pair{"ft", 304.8}, std::pair{"micron", 0.001}, std::pair{"millimeter", 1.0},
          std::pair{"centimeter", 10.0}, std::pair{"inch", 25.4}}) {
        CAPTURE(unit);
        CHECK(mm_per_unit(unit) == Approx(mm));
        CHECK(parse_length_mm("2 " + std::string(unit), "--x") == Approx(2 * mm));
    }
    CHECK_THROWS_AS(mm_per_unit("MM"), UsageError);
    CHECK_THROWS_AS(mm_per_unit(""), UsageError);
}

TEST_CASE("A comma between digits may part decimals, another does not") {
    CHECK(with_decimal_point("1,5") == "1.5");
    CHECK(with_decimal_point("12,75 mm") == "12.75 mm");
    for (const char* other : {"", "15", ",5", "5,", "a,5", "5,a", "5, 1", " ,5", "5 ,1"})
        CHECK(with_decimal_point(other).empty());
    CHECK(with_decimal_point("0,9") == "0.9");  // the first and last digits
    CHECK(with_decimal_point("9,0") == "9.0");
    CHECK(with_decimal_point("/,0").empty());  // and the letters beside them
    CHECK(with_decimal_point(":,0").empty());
    CHECK_THROWS_WITH(parse_length_mm("1,5mm", "--size"),
                      Catch::Matchers::Contains("1.5mm") && Catch::Matchers::Contains("--size"));
    CHECK_THROWS_WITH(parse_length_mm("6 parsec", "--size"), Catch::Matchers::Contains("unknown unit 'parsec'"));
    CHECK(parse_length_mm("  60  ", "--size") == 60);
}

TEST_CASE("Memory and times take units as lengths do, and say those that they know") {
    CHECK(parse_memory_gib("2", "--memory") == 2);
    CHECK(parse_memory_gib("2GiB", "--memory") == 2);
    CHECK(parse_memory_gib("512 MiB", "--memory") == 0.5);
    CHECK(parse_memory_gib("1TiB", "--memory") == 1024);
    CHECK(parse_memory_gib("1GB", "--memory") == Approx(1e9 / (1 << 30)));
    CHECK(parse_memory_gib("64kB", "--memory") == Approx(64e3 / (1 << 30)));
    CHECK(parse_time_s("90", "--read-time") == 90);
    CHECK(parse_time_s("1.5min", "--read-time") == 90);
    CHECK(parse_time_s("2h", "--read-time") == 7200);
    CHECK(parse_time_s("1 d", "--read-time") == 86400);
    using Catch::Matchers::Contains;
    // A gigabit is no gigabyte, and a letter alone is both.
    CHECK_THROWS_WITH(parse_memory_gib("2G", "--memory"), Contains("--memory: '2G'") && Contains("GiB"));
    CHECK_THROWS_WITH(parse_memory_gib("lots", "--memory"), Contains("is not an amount of memory") && Contains("2GiB"));
    CHECK_THROWS_WITH(parse_time_s("2m", "--read-time"), Contains("unknown unit 'm'") && Contains("min"));
}
