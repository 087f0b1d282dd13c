// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/batch/job_names.h"

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("A template is filled with name, number and options") {
    SliceOptions options;
    options.size_mm = 40;
    options.printer = "generic";
    CHECK(NameTemplate("{name}").fill("spot", 7, options) == "spot");
    CHECK(NameTemplate("{name}-{n:03}").fill("spot", 7, options) == "spot-007");
    CHECK(NameTemplate("{n}").fill("spot", 1234, options) == "1234");
    CHECK(NameTemplate("{n:03}").fill("spot", 1234, options) == "1234");
    CHECK(NameTemplate("tray {printer}_{size}").fill("spot", 1, options) == "tray generic_40mm");
}

TEST_CASE("What is no template is refused") {
    for (const char* text : {"", "{", "}", "{name", "name}", "{nam}", "{n:3}", "{n:010}", "{}", "{out}", "{model}"}) {
        INFO(text);
        CHECK_THROWS_AS(NameTemplate(text), UsageError);
    }
}

TEST_CASE("Names are those of folders on any file system") {
    for (const char* good : {"spot", "spot-001", "spot 40mm", "Stühle.v2", "a", "batch-2"}) {
        INFO(good);
        CHECK(name_fault(good).empty());
    }
    const std::string long_one(121, 'x');
    for (const std::string bad : {"", ".", "..", ".hidden", "-o", "a/b", "../a", "a\\b", "C:", "a*", "a\nb", "a\x1b[2J",
                                  "\xff", " a", "a ", "a.", "batch", "index.html", long_one.c_str()}) {
        INFO(bad);
        CHECK(!name_fault(bad).empty());
    }
}
