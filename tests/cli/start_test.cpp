// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `voxtone` loads at its start, and the programs that it becomes or runs for the rest.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <catch2/catch.hpp>

#include "run_program.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

/// What the command prints; empty when it cannot be run.
std::string printed_by(const std::string& command) {
    std::string text;
    std::FILE* const pipe = popen((command + " 2>/dev/null").c_str(), "r");
    if (!pipe) return text;
    char part[4096];
    while (const std::size_t got = std::fread(part, 1, sizeof part, pipe)) text.append(part, got);
    pclose(pipe);
    return text;
}

/// `run_program` where the helper programs are looked for in this folder.
Outcome run_with_helpers_in(const std::string& folder, const std::string& arguments) {
    const char* const old = std::getenv("VOXTONE_HELPERS");
    const std::string before = old ? old : "";
    setenv("VOXTONE_HELPERS", folder.c_str(), 1);
    Outcome outcome = run_program(arguments);
    setenv("VOXTONE_HELPERS", before.c_str(), 1);  // empty is as good as none
    return outcome;
}

constexpr const char* slow_libraries[] = {"assimp",   "OpenImageIO", "opencv",    "ceres",
                                          "liblcms2", "libcholmod",  "liblapack", "openvdb"};

}  // namespace

TEST_CASE("voxtone links no library that most of its verbs do without") {
    const std::string direct = printed_by("readelf -d " + program());
    if (direct.empty()) {
        skip("readelf is not here");
    } else {
        REQUIRE_THAT(direct, Contains("NEEDED"));
        for (const char* library : slow_libraries) CHECK_THAT(direct, !Contains(library));
    }
    const std::string all = printed_by("ldd " + program());
    if (all.empty()) {
        skip("ldd is not here");
    } else {
        REQUIRE_THAT(all, Contains("libc.so"));
        for (const char* library : slow_libraries) CHECK_THAT(all, !Contains(library));
        CHECK(std::count(all.begin(), all.end(), '\n') < 60);
    }
}

TEST_CASE("calibration starts without the 200 libraries that write photographs") {
    const std::string all = printed_by("ldd '" + helpers_dir() + "/voxtone-calibrate'");
    if (all.empty()) return skip("ldd is not here");
    REQUIRE_THAT(all, Contains("libopencv"));
    CHECK_THAT(all, !Contains("OpenImageIO"));
}

TEST_CASE("calibrate is a verb like the others, in a program of its own") {
    CHECK_THAT(run_program("--help").out, Contains("calibrate"));
    const Outcome help = run_program("calibrate --help");
    CHECK(help.exit_code == 0);
    CHECK_THAT(help.out, Contains("Usage: voxtone calibrate") && Contains("simulate-profile"));
    CHECK(run_program("calibrate").exit_code == 2);
    CHECK(run_program("calibrate fit --bogus").exit_code == 2);
    const Outcome missing = run_program("calibrate check vero-opaque /nowhere/patches.csv");
    CHECK(missing.exit_code == 4);
    CHECK_THAT(missing.err, Contains("voxtone: ") && Contains("/nowhere/patches.csv"));
}

TEST_CASE("help, completion and mistakes need no program but voxtone itself") {
    const auto run = [](const std::string& arguments) { return run_with_helpers_in("/nowhere", arguments); };
    for (const std::string verb :
         {"slice", "estimate", "predict", "proof", "compare", "verify", "list", "laminate", "laminate search",
          "calibrate", "calibrate fit", "calibrate photo", "calibrate profile", "calibrate target"}) {
        INFO(verb);
        const Outcome help = run(verb + " --help");
        CHECK(help.exit_code == 0);
        CHECK_THAT(help.out, Contains("Usage: voxtone " + verb + " "));
        CHECK(run(verb + " --bogus").exit_code == 2);
    }
    CHECK_THAT(run("--help-all").out, Contains("--checker-corners"));
    CHECK(run("complete calibrate phot").out == "photo\n");
}

TEST_CASE("helper programs that are missing are told in one sentence") {
    const Folder folder("helpers");
    folder.write("marker.obj", marker_obj());
    const Outcome slice =
        run_with_helpers_in("/nowhere", "slice " + (folder / "marker.obj") + " -o " + (folder / "out"));
    CHECK(slice.exit_code == 4);
    CHECK_THAT(slice.err, Contains("voxtone-read") && Contains("/nowhere") && Contains("install voxtone again"));
    const Outcome calibrate = run_with_helpers_in("/nowhere", "calibrate check vero-opaque patches.csv");
    CHECK(calibrate.exit_code == 4);
    CHECK_THAT(calibrate.err, Contains("voxtone: voxtone-calibrate") && Contains("/nowhere"));
    CHECK(run_with_helpers_in("/nowhere", "list printers").exit_code == 0);
}
