// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a chart, or a profile of the printer, to its resins, as an operator does it.
#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "calibration/patches/patch_file.h"
#include "io/profiles/resin_file.h"
#include "run_program.h"
#include "tests/calibration/chart/icc_samples.h"
#include "tests/calibration/patches/target_samples.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

nlohmann::json details(const Folder& folder, const std::string& name) {
    return nlohmann::json::parse(read_file(folder / name));
}

}  // namespace

TEST_CASE("a chart is printed, filled in, fitted together with squares, shown and sliced with") {
    const Folder folder("calibrate_chart");
    const auto run = [&](const std::string& arguments) {
        const Outcome outcome = run_program("calibrate " + arguments);
        INFO(arguments << "\n" << outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return outcome;
    };
    run(fmt::format("chart --quiet --printer stratasys-j750-hm --resins C,M,Y,K,W --patches 24 --square 3mm -o {}",
                    folder / "chart"));
    CHECK_THAT(read_file(folder / "chart/chart.csv"), Contains("row,column") && Contains("L,a,b"));
    // The form alone says nothing yet.
    const Outcome empty =
        run_program(fmt::format("calibrate fit {} -o {}", folder / "chart/chart.csv", folder / "no.json"));
    CHECK(empty.exit_code == 3);
    CHECK_THAT(empty.err, Contains("chart.csv"));
    CHECK_FALSE(std::filesystem::exists(folder / "no.json"));

    run(fmt::format("simulate {} --resins vero-opaque -o {}", folder / "chart/target.json", folder / "measured.csv"));
    calibration::PatchTable squares = calibration::testing::target('B', {"C", "M", "Y"});
    calibration::testing::measure(squares, optics::vero_opaque(), 0, 3);
    folder.write("squares.csv", calibration::patch_table_text(squares, "target B"));
    const Outcome fit = run(fmt::format("fit {} --squares {} --channels 3 -o {} --report {}", folder / "measured.csv",
                                        folder / "squares.csv", folder / "my.json", folder / "my.html"));
    CHECK_THAT(fit.out, Contains("mixtures left out of the fit") && Contains("thin squares left out") &&
                            Contains("White scatters"));
    const nlohmann::json json = details(folder, "my.fit.json");
    CHECK(json.at("squares_held_out").at("count") == squares.patches.size());
    CHECK(json.at("length_error").size() == 3);
    CHECK_THAT(read_file(folder / "my.html"), Contains("Mixtures that took no part") && Contains("Fit of my"));
    CHECK_THAT(io::read_resin_set(folder / "my.json").source, Contains("20 thin squares"));

    folder.write("marker.obj", marker_obj());
    CHECK(run_program(fmt::format("slice --quiet --no-report --iterations 0 {} --resins {} -o {}",
                                  folder / "marker.obj", folder / "my.json", folder / "out"))
              .exit_code == 0);
    // A target of squares is no chart to add squares to.
    const Outcome twice = run_program(fmt::format("calibrate fit {} --squares {} -o {}", folder / "squares.csv",
                                                  folder / "squares.csv", folder / "twice.json"));
    CHECK(twice.exit_code == 2);
    CHECK_THAT(twice.err, Contains("--squares"));
}

TEST_CASE("a printer's ICC profile gives resins, other files are refused") {
    const Folder folder("calibrate_icc");
    folder.write("printer.icc", calibration::testing::profile_of({}, calibration::testing::straight));
    folder.write("no.icc", "not a profile");
    const Outcome made = run_program(fmt::format("calibrate icc {} --patches 40 --channels 3 --chart {} -o {}",
                                                 folder / "printer.icc", folder / "chart.csv", folder / "icc.json"));
    INFO(made.err);
    REQUIRE(made.exit_code == 0);
    CHECK(io::read_resin_set(folder / "icc.json").resins.size() == 5);
    CHECK_THAT(read_file(folder / "chart.csv"), Contains("L,a,b"));
    const Outcome refused = run_program(fmt::format("calibrate icc {} -o {}", folder / "no.icc", folder / "none.json"));
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("no ICC profile"));
    CHECK(run_program(fmt::format("calibrate icc {} -o {}", folder / "missing.icc", folder / "none.json")).exit_code ==
          4);
    CHECK_FALSE(std::filesystem::exists(folder / "none.json"));
}
