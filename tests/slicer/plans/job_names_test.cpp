// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/job_names.h"

#include <set>
#include <string>
#include <vector>

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

TEST_CASE("Every model's name gives a job's name, and two give two") {
    CHECK(name_after("Stühle v2") == "Stühle v2");
    CHECK(name_after("caf\xE9") == "caf%E9");
    CHECK(name_after("a:b\n") == "a%3Ab%0A");
    CHECK(name_after(".hidden.") == "%2Ehidden%2E");
    CHECK(name_after("batch") == "batch_");
    std::set<std::string> names;
    std::vector<std::string> models{"-o",
                                    " a",
                                    "a ",
                                    "a.",
                                    "index.html",
                                    "a\x1b[2J",
                                    "\xC2\x9B",
                                    "\xff",
                                    "\xfe",
                                    std::string(250, 'x'),
                                    std::string(251, 'x'),
                                    std::string(80, '\xE9')};
    std::string umlauts;
    for (int i = 0; i < 100; ++i) umlauts += "ü";
    models.push_back(umlauts);
    for (const std::string& model : models) {
        INFO(model);
        CHECK(name_fault(name_after(model)).empty());
        names.insert(name_after(model));
    }
    CHECK(names.size() == models.size());
}
