// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/command_words.h"

#include <array>
#include <cstdio>

#include <catch2/catch.hpp>

#include "slicer/options/resolve_job.h"

using namespace voxtone::slicer;
using Words = std::vector<std::string>;

TEST_CASE("A command says what is not at its default") {
    SliceOptions options;
    CHECK(command_words(options) == Words{"slice"});
    options.model = "/m/a b.obj";
    options.out = "/o";
    options.size_mm = 40;
    options.report = false;
    options.resume = true;
    options.load = {"C", "W"};
    options.rotate = "-x90";
    CHECK(command_words(options) == Words{"slice", "/m/a b.obj", "--out", "/o", "--no-report", "--size", "40mm",
                                          "--rotate=-x90", "--load", "C,W", "--resume"});
}

TEST_CASE("A shell takes a line apart into the same words") {
    const Words words{"slice", "/m/a b.obj", "it's", "", "$(x) `y` \"z\" \\ *", "--size=40mm", "ä"};
    const std::string command = "printf '%s\\n' " + shell_line(words);
    std::FILE* const shell = popen(command.c_str(), "r");
    REQUIRE(shell);
    std::string said;
    for (std::array<char, 256> piece{}; std::fgets(piece.data(), piece.size(), shell);) said += piece.data();
    pclose(shell);
    std::string wanted;
    for (const std::string& word : words) wanted += word + "\n";
    CHECK(said == wanted);
    CHECK(shell_line(Words{"slice", "a.obj", "--size", "40mm"}) == "slice a.obj --size 40mm");
}

TEST_CASE("What a job would ignore of a preset is left out, what was said of it is not") {
    SliceOptions options;
    options.model = "/m/picture.png";
    options.out = "/o";
    options.size_mm = 40;  // for a mesh
    options.width_mm = 50;
    SliceOptions dropped = options;
    drop_idle(dropped, {});
    CHECK(dropped.size_mm == 0);
    CHECK(dropped.width_mm == 50);
    CHECK_NOTHROW(resolve(dropped));
    SliceOptions kept = options;
    drop_idle(kept, Words{"size"});
    CHECK(kept.size_mm == 40);
    CHECK_THROWS(resolve(kept));
}
