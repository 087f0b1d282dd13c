// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/printing_time.h"

#include <catch2/catch.hpp>

#include "slicer/printer/printer.h"

using namespace voxtone::slicer;
using Catch::Contains;

TEST_CASE("Passes go by the width across the heads' way, and what is as wide as a strip takes one") {
    const HeadPasses heads{0, 50, {}, "a guide"};
    CHECK(heads.of_layer({490, 50, 10}) == 1);
    CHECK(heads.of_layer({1, 50.1, 10}) == 2);
    CHECK(heads.of_layer({25, 289.7, 10}) == 6);
    CHECK(heads.of_layer({289.7, 25, 10}) == 1);
    CHECK(HeadPasses{1, 50, {}, ""}.of_layer({289.7, 25, 10}) == 6);
    CHECK(HeadPasses{}.of_layer({289.7, 25, 10}) == 0);
}

TEST_CASE("Trays that are printed one after the other add up, and the time is said where a pass has one") {
    PrintingTime time;
    time.add({0, 50, {}, "a guide"}, {400, 120, 10}, 100);
    time.add({0, 50, {}, "a guide"}, {400, 40, 10}, 200);
    CHECK(time.passes == 500);
    CHECK(time.passes_of_layer == 3);
    CHECK_FALSE(time.seconds);
    CHECK_THAT(printing_text(time), Contains("500 passes") && Contains("3 a layer") && Contains("pass_s"));
    PrintingTime timed;
    timed.add({0, 50, 9.0, "a guide"}, {400, 120, 10}, 100);
    CHECK(timed.seconds == 2700);
    CHECK_THAT(printing_text(timed), Contains("some 45 min"));
    CHECK(printing_text(PrintingTime{}).empty());
}

TEST_CASE("Heads of the J750 run along x, of a swapped profile along y of the model") {
    const PrinterProfile printer = find_printer("stratasys-j750-hm");
    CHECK(printer.sliced_passes().along == 0);
    CHECK(printer.sliced_passes().width_mm == 50);
    CHECK_THAT(printer.passes.source, Contains("Connex3 User Guide") && Contains("5-25"));
    PrinterProfile swapped = printer;
    swapped.orientation.swap_xy = true;
    CHECK(swapped.sliced_passes().along == 1);
    CHECK_FALSE(find_printer("stratasys-j55").passes.known());  // its tray turns
}
