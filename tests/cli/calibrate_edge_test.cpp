// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps of `calibrate edge` as a user runs them: samples, simulate, photo, dictionary, fit.
#include <cmath>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "calibration/edge/edge_profiles.h"
#include "calibration/edge/edge_setup.h"
#include "io/pictures/photograph.h"
#include "io/pictures/photograph_writer.h"
#include "io/profiles/resin_file.h"
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

const std::string coarse_bench = R"({"format": "voxtone-edge-setup", "version": 1,
 "camera": {"pitch_mm": 0.08, "blur_mm": 0.08, "level_error": 0.01}})";

// Two resins whose slabs show the edge.
std::string simulate(const Folder& folder, const std::string& more, const std::string& roles = "M,K",
                     int paths = 16384) {
    return fmt::format(
        "calibrate edge simulate --resins vero-opaque --roles {} --setup {} --paths {} --seed 3 --json {}", roles,
        folder / "bench.json", paths, more);
}

// For all tests of the fit: few extinctions about the resins', few paths.
std::string small_dictionary(const Folder& folder, const std::string& more = {}) {
    return fmt::format(
        "calibrate edge dictionary --setup {} --sigma-t 1.8,2.3,2.9,3.7,4.7,6,7.6,9.7,12.3 --g 0.4 --paths 16384 "
        "--json -o {} {}",
        folder / "bench.json", folder / "edges.dict", more);
}

// Traced once.
std::string edge_dictionary() {
    static const Folder folder("edge-dictionary");
    static const nlohmann::json made = [] {
        folder.write("bench.json", coarse_bench);
        return result_of(run_program(small_dictionary(folder)));
    }();
    CHECK(made["format"] == "voxtone-calibrate-edge-dictionary");
    return folder / "edges.dict";
}

void refuse(const std::string& arguments, int code, const std::string& why) {
    const Outcome outcome = run_program(arguments);
    INFO(arguments << "\n" << outcome.out << outcome.err);
    CHECK(outcome.exit_code == code);
    CHECK_THAT(outcome.err + outcome.out, Contains(why));
}

}  // namespace

TEST_CASE("edge samples: slabs and sheet to print") {
    const Folder folder("edge-samples");
    const std::string command =
        "calibrate edge samples --resins C,W --size 12mm --allowance 0.05mm --json -o " + (folder / "slabs");
    const nlohmann::json result = result_of(run_program(command));
    CHECK(result["slabs"] == 4);
    CHECK(result["size_mm"][2].get<double>() == Approx(1.05));
    CHECK_THAT(read_file(result["sheet"].get<std::string>()), Contains("<svg") && Contains("210mm"));
    CHECK(run_program("verify " + (folder / "slabs")).exit_code == 0);
    refuse(command, 3, "--overwrite");
    CHECK(run_program(command + " --overwrite").exit_code == 0);
    refuse("calibrate edge samples -o " + (folder / "a"), 2, "--resins");
    refuse("calibrate edge samples --resins C,W --size 5mm -o " + (folder / "a"), 3, "--size");
    refuse("calibrate edge samples --resins C,W --thickness 0 -o " + (folder / "a"), 3, "--thickness");
}

TEST_CASE("edge: photographs of slabs become profiles, and profiles resins") {
    const Folder folder("edge-photo");
    folder.write("bench.json", coarse_bench);
    const nlohmann::json simulated = result_of(
        run_program(simulate(folder, "--bias 0.95 --thickness-off 0.02 --gel 0.01,0.05 --field 96,72 --photos " +
                                         (folder / "photos") + " -o " + (folder / "truth.csv"))));
    CHECK(simulated["count"] == 4);
    REQUIRE(simulated["slabs"].size() == 4);
    for (const auto& slab : simulated["slabs"]) {
        CHECK(slab["gel_above_mm"].get<double>() >= 0.01);
        CHECK(slab["gel_below_mm"].get<double>() <= 0.05);
    }
    CHECK(simulated["slabs"][0]["gel_above_mm"] != simulated["slabs"][1]["gel_above_mm"]);
    const std::string list = folder / "photos/photographs.csv";
    CHECK(simulated["photographs"] == list);

    const std::string photo = fmt::format("calibrate edge photo {} --setup {} --write-setup {} --json -o {}", list,
                                          folder / "bench.json", folder / "setup.json", folder / "profiles.csv");
    const Outcome outcome = run_program(photo);
    const nlohmann::json read = result_of(outcome);
    CHECK(read["count"] == 4);
    CHECK(read["photographs"].size() == 8);
    CHECK(read["camera"]["pitch_mm"].get<double>() == Approx(0.08).epsilon(3e-4));
    CHECK(read["camera"]["blur_mm"].get<double>() == Approx(0.08).epsilon(0.06));
    CHECK(read["unevenness"].get<double>() < 0.012);
    CHECK_THAT(outcome.out, Contains("say linearly"));
    for (const auto& one : read["photographs"]) {
        CHECK(read_png(one["overlay"].get<std::string>()).width > 500);
        CHECK(one["turn_deg"].get<double>() == Approx(2).margin(0.03));
    }
    CHECK(read_png(folder / "profiles-overlays/light.png").width > 100);
    CHECK(read_png(folder / "profiles-overlays/sheet.png").width > 500);

    // Within their errors of what the camera should have seen.
    const auto profiles = calibration::read_edge_profiles(folder / "profiles.csv"),
               truth = calibration::read_edge_profiles(folder / "truth.csv");
    const double level = read["camera"]["level_error"].get<double>();
    REQUIRE(profiles.size() == truth.size());
    for (std::size_t p = 0; p < profiles.size(); ++p) {
        REQUIRE(profiles[p].resin == truth[p].resin);
        REQUIRE(profiles[p].x_mm.size() == truth[p].x_mm.size());
        for (std::size_t c = 0; c < 3; ++c) {
            double chi2 = 0, chi2_wrong = 0;
            for (std::size_t k = 0; k < truth[p].x_mm.size(); ++k) {
                const double t = truth[p].value[c][k], error2 = std::pow(profiles[p].error[c][k], 2) +
                                                                std::pow(truth[p].error[c][k], 2) +
                                                                std::pow(level * t, 2);
                chi2 += std::pow(profiles[p].value[c][k] - t, 2) / error2 / double(truth[p].x_mm.size());
                chi2_wrong += std::pow(profiles[p].value[c][k] - 1.05 * t, 2) / error2 / double(truth[p].x_mm.size());
            }
            INFO(profiles[p].resin << " " << profiles[p].thickness_mm << " " << c << ": " << chi2 << ", 5 % wrong "
                                   << chi2_wrong);
            CHECK(chi2 < 1.6);
            if (truth[p].value[c].back() > 0.1) CHECK(chi2_wrong > 4);
        }
    }
    // What was measured of the sheet, as setup.json.
    const calibration::EdgeSetup setup = calibration::read_edge_setup(folder / "setup.json"), usual;
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(setup.white[c] == Approx(usual.white[c]).margin(0.005));
        CHECK(setup.black[c] == Approx(usual.black[c]).margin(0.002));
    }

    // Files that are there stay.
    refuse(photo, 3, "--overwrite");

    // On to the resins.
    const std::string fit = fmt::format("calibrate edge fit {} --setup {} --dictionary {} --report {} --json -o {}",
                                        folder / "profiles.csv", folder / "setup.json", edge_dictionary(),
                                        folder / "resins.html", folder / "resins.json");
    const nlohmann::json fitted = result_of(run_program(fit));
    CHECK(fitted["mu"].get<double>() == Approx(0.95).margin(0.03));
    const optics::ResinSet known = io::find_resin_set("vero-opaque"),
                           found = io::read_resin_set(folder / "resins.json");
    for (const auto& [role, channel] : {std::pair("K", 0), std::pair("K", 1), std::pair("K", 2), std::pair("M", 2)}) {
        const double is = found.resins.at(std::size_t(found.find(role))).sigma_t_per_mm[std::size_t(channel)],
                     was = known.resins.at(std::size_t(known.find(role))).sigma_t_per_mm[std::size_t(channel)];
        INFO(role << channel << ": " << is << " for " << was);
        CHECK(is == Approx(was).epsilon(0.1));
    }
    CHECK_THAT(read_file(folder / "resins.html"), Contains("<svg"));
    CHECK(std::filesystem::exists(folder / "resins.edge.json"));
    refuse(fit, 3, "--overwrite");
}

TEST_CASE("edge photo: what cannot be measured is refused, and nothing is left under the profiles' name") {
    const Folder folder("edge-refused");
    folder.write("bench.json", coarse_bench);
    static_cast<void>(result_of(run_program(
        simulate(folder, "--thickness 0.5 --shots 1 --field 96,72 --photos " + (folder / "photos"), "K", 1024))));
    const std::string good = read_file(folder / "photos/photographs.csv");
    const auto photo = [&](const std::string& list, const std::string& more = {}) {
        folder.write("photos/list.csv", list);
        return fmt::format("calibrate edge photo {} --setup {} --overwrite -o {} {}", folder / "photos/list.csv",
                           folder / "bench.json", folder / "p.csv", more);
    };
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string changed = good;
        const std::size_t at = changed.find(from);
        REQUIRE(at != std::string::npos);
        return changed.replace(at, from.size(), to);
    };
    // Which photographs can be measured: tests/calibration/bench. Here one of each kind of refusal, by its exit code.
    refuse(photo(replaced("K-0.5-1.tif,slab", "none.tif,slab")), 4, "none.tif");
    refuse(photo(replaced("K-0.5-1.tif,slab", "sheet.tif,slab")), 3, "there is no slab");
    io::Photograph cropped = io::read_photograph(folder / "photos/K-0.5-1.tif");
    cropped.height_px -= 20;
    cropped.pixels.resize(cropped.index(0, cropped.height_px));
    const auto bytes = io::photograph_bytes(cropped, "cropped.tif");
    folder.write("photos/cropped.tif", std::string(bytes.begin(), bytes.end()));
    refuse(photo(replaced("K-0.5-1.tif,slab", "cropped.tif,slab")), 3, "the same camera");
    refuse(photo(replaced("slab,K,0.5", "slab,K,")), 3, "thickness_mm");
    refuse(photo(good, "--coding srgb"), 3, "checker");
    refuse(photo(good, "--square 3mm"), 3, "--square");
    refuse(photo(good, "--along 30mm"), 3, "--along");
    refuse(photo(good, "--checker-corners 1,2,3"), 2, "--checker-corners");
    refuse("calibrate edge photo -o p.csv", 2, "list");
    CHECK_FALSE(std::filesystem::exists(folder / "p.csv"));
    // One slab can be measured, and what is wanting is said; the same for any number of threads.
    const Outcome one = run_program(photo(good, "--threads 1"));
    CHECK(one.exit_code == 0);
    CHECK_THAT(one.err, Contains("one thickness only") && Contains("one resin only") && Contains("take a second one"));
    const std::string written = read_file(folder / "p.csv");
    CHECK(run_program(photo(good, "--threads 2")).exit_code == 0);
    CHECK(read_file(folder / "p.csv") == written);
}

// What else is: tests/calibration/edge.
TEST_CASE("edge fit: bad input is refused or told") {
    const Folder folder("edge-bad");
    folder.write("bench.json", coarse_bench);
    static_cast<void>(result_of(run_program(simulate(folder, "-o " + (folder / "good.csv")))));
    const auto good = calibration::read_edge_profiles(folder / "good.csv");
    REQUIRE(good.size() == 4);  // M and K, 0.5 and 1 mm each
    const auto fit = [&](const std::vector<calibration::EdgeProfile>& profiles) {
        folder.write("bad.csv", calibration::edge_profiles_text(profiles));
        return fmt::format("calibrate edge fit {} --setup {} --dictionary {} --overwrite -o {}", folder / "bad.csv",
                           folder / "bench.json", edge_dictionary(), folder / "r.json");
    };
    const Outcome usual = run_program(fit(good));
    CHECK(usual.exit_code == 0);
    CHECK_THAT(usual.err, !Contains("no resin has these profiles") && !Contains("one thickness only"));
    auto wrong = good;
    std::swap(wrong[0].thickness_mm, wrong[1].thickness_mm);
    refuse(fit({wrong[1], wrong[0], wrong[2], wrong[3]}), 0, "as thick as the table says");
    wrong = good;
    wrong[0].thickness_mm = 0.7;
    refuse(fit(wrong), 3, "0.7 mm");
}

TEST_CASE("edge dictionary and simulate: options and files") {
    const Folder folder("edge-options");
    folder.write("bench.json", coarse_bench);
    refuse("calibrate edge simulate", 2, "--photos");
    refuse(simulate(folder, "-o " + (folder / "a.csv"), "Q"), 3, "Q");
    refuse(simulate(folder, "--gel 0.05,0.01 -o " + (folder / "a.csv")), 3, "--gel");
    refuse(simulate(folder, "--turn 80 --photos " + (folder / "a")), 3, "--turn");
    refuse(simulate(folder, "--field 20,20 --photos " + (folder / "a")), 3, "--field");
    refuse(simulate(folder, "--shots 0 --photos " + (folder / "a")), 3, "--shots");
    refuse(simulate(folder, "-o " + (folder / "a.csv"), "M,K", 10), 3, "--paths");
    CHECK_FALSE(std::filesystem::exists(folder / "a.csv"));
    refuse("calibrate edge dictionary", 2, "--out");
    refuse(small_dictionary(folder, "--shard 3/2"), 2, "--shard");
    const nlohmann::json estimate = result_of(run_program(small_dictionary(folder, "--estimate")));
    CHECK(estimate.dump().find("seconds") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "edges.dict"));
    refuse("calibrate edge fit none.csv -o " + (folder / "r.json"), 4, "none.csv");
    refuse("calibrate edge fit -o r.json", 2, "profiles");
    refuse("calibrate edge fit none.csv --g big -o " + (folder / "r.json"), 2, "--g");
}
