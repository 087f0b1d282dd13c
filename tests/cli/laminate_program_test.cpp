// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

nlohmann::json result_of(const std::string& out) {
    const std::size_t begin = out.rfind('\n', out.size() - 2);
    return nlohmann::json::parse(out.substr(begin == std::string::npos ? 0 : begin + 1)).at("result");
}

}  // namespace

TEST_CASE("laminate predict and laminate search hand profiles and laminates to each other") {
    const Folder folder("laminate-search");
    const std::string target = folder / "jade.json";
    const Outcome predicted =
        run_program(fmt::format("laminate predict \"W 0.3, Y 1mm\" --paths 4096 --coefficients 128 --json -o {} -o {}",
                                target, folder / "jade.svg"));
    REQUIRE(predicted.exit_code == 0);
    const double wanted = result_of(predicted.out)["channels"][1]["layers"]["R"]["total"];
    const Outcome found =
        run_program(fmt::format("laminate search {} --materials W,Y,K --thickness 3mm --steps 32 --max-blocks 4 "
                                "--clear-top Y=0.1mm --layer 27um --rounds 1 "
                                "--paths 4096 --coefficients 16 --json -o {}",
                                target, folder / "out"));
    REQUIRE(found.exit_code == 0);
    const auto result = result_of(found.out)["results"][0];
    CHECK(result["channels"][1]["target"]["total"].get<double>() == Approx(wanted).margin(1e-6));
    CHECK(result["all_directions_distance"].get<double>() < 0.03);
    CHECK(result["visited"].get<int>() > 0);
    const Outcome again = run_program(
        fmt::format("laminate predict {} --paths 4096 --coefficients 16 --check", folder / "out/jade.laminate.json"));
    REQUIRE(again.exit_code == 0);
    CHECK_THAT(again.out, Contains("Monte Carlo"));

    CHECK(run_program("laminate").exit_code == 2);
    CHECK(run_program("laminate predict \"W thick\"").exit_code == 2);
    CHECK(run_program("laminate predict no-such.json").exit_code == 4);
    const Outcome twice = run_program(fmt::format("laminate search {} --materials W -o {}", target, folder / "out"));
    CHECK(twice.exit_code == 3);
    CHECK_THAT(twice.err, Contains("--overwrite"));
}

TEST_CASE("laminate targets and laminate print begin and end the road to printed slabs") {
    const Folder folder("laminate-print");
    const Outcome targets =
        run_program(fmt::format("laminate targets \"W 1\" \"W 0.2, T 0.5, W 0.3\" --resins vero-opaque-clear --count 2 "
                                "--paths 4096 --coefficients 32 --json -o {}",
                                folder / "targets"));
    REQUIRE(targets.exit_code == 0);
    const auto made = result_of(targets.out)["targets"];
    REQUIRE(made.size() == 2);
    CHECK(made[0]["channels"][1]["80_percent_within_mm"].get<double>() <
          made[1]["channels"][1]["80_percent_within_mm"].get<double>());
    const Outcome printed = run_program(fmt::format(
        "laminate print \"W 0.3, K 0.6\" \"W 0.9\" --width 2mm --depth 2mm --json -o {}", folder / "print"));
    REQUIRE(printed.exit_code == 0);
    CHECK(result_of(printed.out)["slabs"].size() == 2);
    CHECK(run_program("verify " + (folder / "print")).exit_code == 0);
    CHECK(run_program("laminate print -o " + (folder / "none")).exit_code == 2);
    CHECK(run_program("laminate print \"W 0\" -o " + (folder / "none")).exit_code == 2);
    CHECK(run_program("laminate print \"Q 1\" -o " + (folder / "none")).exit_code == 3);
    CHECK(run_program("laminate targets \"W 1\" no.json -o " + (folder / "none")).exit_code == 4);
}

TEST_CASE("predict sees a slab by layer profiles") {
    const Folder folder("layered");
    folder.write("box.obj", ramp_box_obj(4, 3, 2));
    REQUIRE(run_program(
                fmt::format("slice --quiet --no-report --iterations 0 {} -o {}", folder / "box.obj", folder / "out"))
                .exit_code == 0);
    REQUIRE(run_program(
                fmt::format("predict --quiet --predict layered-profile {} -o {}", folder / "out", folder / "seen.png"))
                .exit_code == 0);
    const Bitmap picture = read_png(folder / "seen.png");
    REQUIRE(picture.width > 10);
    CHECK(picture.at(1, picture.height / 2)[0] > picture.at(1, picture.height / 2)[1]);  // red on the left
    CHECK(picture.at(picture.width - 2, picture.height / 2)[1] > picture.at(picture.width - 2, picture.height / 2)[0]);
    CHECK(run_program(fmt::format("slice --quiet --no-report --iterations 2 --loop-model layered-profile {} -o {}",
                                  folder / "box.obj", folder / "looped"))
              .exit_code == 0);
}
