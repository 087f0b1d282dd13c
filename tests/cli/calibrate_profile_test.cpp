// SPDX-License-Identifier: GPL-3.0-or-later
//
// `calibrate simulate-profile` and `calibrate profile` as a user runs them.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/profiles/profile_file.h"
#include "run_program.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

nlohmann::json result_of(const Outcome& outcome) {
    INFO(outcome.out << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const auto last = outcome.out.rfind("{\"event\":\"result\"");
    REQUIRE(last != std::string::npos);
    return nlohmann::json::parse(outcome.out.substr(last))["result"];
}

constexpr const char* camera = " --size 128 --exposures 0.1,0.8,6.4 --paths 4096 --offset 1.5,-2.25 ";

std::string simulate(const Folder& folder) {
    return std::string("calibrate simulate-profile vero-opaque K --thickness 0.75mm --json -o ") + folder / "lab" +
           camera;
}

}  // namespace

TEST_CASE("A slab that was simulated is measured with the command that the simulation names") {
    const Folder folder("profile");
    const nlohmann::json simulated = result_of(run_program(simulate(folder)));
    const std::string next = simulated["next"].get<std::string>(), prefix = "voxtone ";
    REQUIRE(next.starts_with(prefix));
    std::string command = next.substr(prefix.size());
    command.replace(command.find("profile.json"), 12, folder / "k.json");
    const nlohmann::json measured = result_of(run_program(command + " --json --spot 0.06mm"));
    for (const char* side : {"R", "T"}) {
        CHECK(std::abs(measured[side]["centre_px"][0].get<double>() - 65.5) < 0.02);
        CHECK(std::abs(measured[side]["centre_px"][1].get<double>() - 61.75) < 0.02);
        CHECK(measured[side]["seconds"] ==
              nlohmann::json::parse("[0.10000000149011612,0.800000011920929,6.400000095367432]"));
    }
    CHECK(measured["blurred_from_per_mm"].get<double>() == Approx(2.41).epsilon(0.01));
    const io::ProfileFile profile = io::read_profile(folder / "k.json"),
                          truth = io::read_profile(folder / "lab/truth.json");
    CHECK(profile.name == "k");
    REQUIRE(profile.by_channel.size() == 3);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(profile.by_channel[c].thickness_mm == 0.75);
        // The card lies half a picture beside the slab, in light that is 1 % weaker.
        CHECK(*profile.by_channel[c].R.total == Approx(1.01 * *truth.by_channel[c].R.total).epsilon(0.005));
        CHECK(*profile.by_channel[c].T.total == Approx(*truth.by_channel[c].T.total).epsilon(0.01));
        for (std::size_t i = 4; i < 12;
             ++i) {  // samples are means over tents, the truth is at points: a few percent here
            CHECK(profile.by_channel[c].R.light[i] == Approx(truth.by_channel[c].R.light[i]).epsilon(0.06));
            CHECK(profile.by_channel[c].T.light[i] == Approx(truth.by_channel[c].T.light[i]).epsilon(0.06));
        }
        CHECK(profile.by_channel[c].R.error.size() == profile.by_channel[c].R.light.size());
    }
    CHECK_THAT(read_file(measured["plot"].get<std::string>()), Contains("<svg") && Contains("k: transmitted"));

    // Seconds by hand, and the other side left out: a target.
    const std::string lab = folder / "lab";
    const std::string by_hand = fmt::format(
        "calibrate profile --reflection {0}/reflection-01.exr@1/10 {0}/reflection-02.exr@0.8 --reflection-dark "
        "{0}/reflection-dark-01.exr@1/10 "
        "{0}/reflection-dark-02.exr@0.8 --reflectance 0.05,0.05,0.05 --mm-per-px 0.04 --reach 2mm --name wanted "
        "--overwrite -o "
        "{0}/target.json ",
        lab);
    CHECK(result_of(run_program(by_hand + "--json"))["R"]["samples"] == 46);
    CHECK(io::read_profile(folder / "lab/target.json").is_target());
    CHECK(run_program(by_hand + "--thickness 1mm").exit_code == 2);

    // Faults of photographs in even light.
    const auto even = [&](const std::string& from, const std::string& to) {
        std::string other = command;
        REQUIRE(other.find(from) != std::string::npos);
        return run_program(other.replace(other.find(from), from.size(), to) + " --overwrite").err;
    };
    const std::string dark = lab + "/card-dark.exr", lit = lab + "/card.exr";
    CHECK_THAT(even("--card-albedo 0.18", "--card-albedo 1.2"), Contains("at most 1"));
    CHECK_THAT(even("--slab-at 8,8,48,112", "--slab-at 8,8,148,112"), Contains("beyond its 128 x 128 pixels"));
    CHECK_THAT(even("--slab-at 8,8,48,112", "--slab-at 8,8,4,4"), Contains("16 pixels"));
    CHECK_THAT(even("--slab-at 8,8,48,112", "--slab-at 8,8,112,112"), Contains("brighter than the other"));
    CHECK_THAT(even("--slab-at 8,8,48,112", ""), Contains("--slab-at is missing"));
    CHECK_THAT(even(lit, dark + "@1"), Contains("no brighter than the dark frame"));
    CHECK_THAT(even("--card " + lit, "--card " + lit + "@2"), Contains("of the same time"));
    CHECK_THAT(even(" --card-dark " + dark, ""), Contains("--card-dark"));
    CHECK_THAT(even("lcd-slab.exr " + lab + "/lcd-screen.exr", "lcd-screen.exr " + lab + "/lcd-slab.exr"),
               Contains("more than there was"));
    CHECK_THAT(even("--card ", "--reflectance 0.1,0.1,0.1 --card "), Contains("give one"));

    // Faults.
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string changed = by_hand;
        changed.replace(changed.find(from), from.size(), to);
        return run_program(changed);
    };
    CHECK_THAT(replaced("dark-02.exr@0.8", "dark-02.exr@0.4").err, Contains("same time"));
    CHECK_THAT(replaced("reflection-02.exr@0.8", "reflection-02.exr@x").err, Contains("seconds"));
    CHECK_THAT(replaced("--reflectance 0.05,0.05,0.05", "").err, Contains("--reflectance"));
    CHECK_THAT(replaced("reflection-02.exr@0.8", "none.exr@0.8").err, Contains("none.exr"));
    CHECK_THAT(replaced(lab + "/reflection-02.exr@0.8", "").err, Contains("1 exposures and 2 dark frames"));
    CHECK_THAT(replaced("--reach 2mm", "--reach 9mm").err, Contains("9 mm does not fit") && Contains("border"));
    CHECK(replaced("--reach 2mm", "--reach 9mm").exit_code == 3);
}

TEST_CASE("The simulation is the same for any number of threads") {
    const Folder one("threads-1"), two("threads-2");
    (void)result_of(run_program(simulate(one) + " --threads 1"));
    (void)result_of(run_program(simulate(two) + " --threads 2"));
    const auto a = read_tree(one.path() / "lab"), b = read_tree(two.path() / "lab");
    REQUIRE(a.size() == 18);
    REQUIRE(b.size() == 18);
    for (std::size_t i = 0; i < a.size(); ++i) {
        INFO(a[i].first);
        CHECK((a[i] == b[i]));
    }
}
