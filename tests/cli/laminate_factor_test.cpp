// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/profiles/bssrdf_file.h"
#include "io/profiles/profile_map.h"
#include "run_program.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Matchers::Contains;

TEST_CASE("laminate dataset and laminate factor make a profile map of a slab, the same for any number of threads") {
    const Folder folder("laminate_factor");
    for (const char* threads : {"1", "3"}) {
        const Outcome data = run_program(
            fmt::format("laminate dataset chess --points 24,20 --radius 4 --paths 200 --feature 3mm --threads {} -o {}",
                        threads, folder / fmt::format("{}.bssrdf", threads)));
        INFO(data.err);
        REQUIRE(data.exit_code == 0);
        CHECK_THAT(data.out, Contains("24 x 20 points at 0.5 mm"));
        const Outcome factor = run_program(fmt::format(
            "laminate factor {} --clusters 8 --picture {} --threads {} -o {} --json", folder / "1.bssrdf",
            folder / fmt::format("{}.picture.png", threads), threads, folder / fmt::format("{}.json", threads)));
        INFO(factor.err);
        REQUIRE(factor.exit_code == 0);
    }
    CHECK(read_file(folder / "1.bssrdf") == read_file(folder / "3.bssrdf"));
    CHECK(read_file(folder / "1.png") == read_file(folder / "3.png"));
    CHECK(read_file(folder / "1.picture.png") == read_file(folder / "3.picture.png"));
    std::string other = read_file(folder / "3.json");
    other.replace(other.find("3.png"), 5, "1.png");
    CHECK(read_file(folder / "1.json") == other);

    const io::ProfileMap map = io::read_profile_map(folder / "1.json");
    CHECK((map.width_px == 24 && map.height_px == 20));
    CHECK(map.width_mm == Approx(12));
    CHECK(map.target.size() == 8);
    CHECK(map.target[0].size() == 3);
    CHECK(map.target[0][0].light.size() == 5);
    // White squares of 6 points: a point in the middle of one is not of the cluster of its translucent neighbour.
    CHECK(map.cluster[2 * 24 + 2] != map.cluster[2 * 24 + 8]);
}

TEST_CASE("laminate factor scales to an albedo, and checks with other data") {
    const Folder folder("laminate_factor_check");
    for (const int seed : {1, 2})
        REQUIRE(
            run_program(
                fmt::format("laminate dataset stone --points 20 --radius 4 --paths 200 --path-seed {} -o {} --quiet",
                            seed, folder / fmt::format("{}.bssrdf", seed)))
                .exit_code == 0);
    const Outcome factor =
        run_program(fmt::format("laminate factor {} --check {} --clusters 5 --max-albedo 0.6 -o {} --json --quiet",
                                folder / "1.bssrdf", folder / "2.bssrdf", folder / "map.json"));
    INFO(factor.err);
    REQUIRE(factor.exit_code == 0);
    const std::size_t last = factor.out.rfind('\n', factor.out.size() - 2);
    const auto json = nlohmann::json::parse(factor.out.substr(last == std::string::npos ? 0 : last + 1)).at("result");
    CHECK(json.at("scale").get<double>() * json.at("brightest_albedo").get<double>() == Approx(0.6));
    CHECK(json.at("clusters").size() == 5);
    for (const auto& channel : json.at("channels")) {
        CHECK(channel.at("converged") == true);
        CHECK(channel.at("factored").at("light").get<double>() == Approx(1).epsilon(1e-3));
        CHECK(channel.at("factored_checked").at("light_error") > channel.at("factored").at("light_error"));
    }
}

TEST_CASE("a map of luminance is printed in resins of three channels and traced, and other single channels are not") {
    const Folder folder("laminate_luminance");
    const auto run = [](const std::string& arguments) {
        const Outcome outcome = run_program(arguments);
        INFO(arguments << "\n" << outcome.err);
        CHECK(outcome.exit_code == 0);
        return outcome;
    };
    run(fmt::format("laminate dataset marble --points 20 --radius 3 --paths 200 --quiet -o {}", folder / "a.bssrdf"));
    const Outcome factor =
        run(fmt::format("laminate factor {} --luminance --clusters 2 -o {}", folder / "a.bssrdf", folder / "a.json"));
    CHECK_THAT(factor.out, Contains("  luminance: ") && !Contains("  red: "));
    io::ProfileMap map = io::read_profile_map(folder / "a.json");
    CHECK(map.target[0].size() == 1);
    const std::string slice = fmt::format(
        "slice {} --show layered-profile --resins vero-opaque-clear --load W,K --laminate-rounds 0 --laminate-steps 16 "
        "--laminate-thickness 1mm --thickness 1.5mm --quiet --profiles ",
        folder / "a.png");
    run(slice + (folder / "a.json") + " -o " + (folder / "out"));
    const Outcome traced = run(
        fmt::format("laminate trace {} --dataset {} --paths 100 --quiet --json", folder / "out", folder / "a.bssrdf"));
    const std::size_t last = traced.out.rfind('\n', traced.out.size() - 2);
    const auto json = nlohmann::json::parse(traced.out.substr(last == std::string::npos ? 0 : last + 1)).at("result");
    const auto& asked = json.at("clusters").at(0).at("asked");
    REQUIRE(asked.size() == 3);
    CHECK(asked[0] == asked[2]);
    CHECK(json.at("clusters").at(0).at("printed")[0] != json.at("clusters").at(0).at("printed")[2]);

    map.channels = {};
    map.channels.wavelengths_nm = {550};
    io::write_profile_map(map, folder / "nm.json");
    const Outcome refused = run_program(slice + (folder / "nm.json") + " -o " + (folder / "no"));
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("laminate factor --luminance"));
}

TEST_CASE("laminate dataset and laminate factor say what is wrong with their input") {
    const Folder folder("laminate_factor_wrong");
    const auto refused = [&](const std::string& arguments, int code, const std::string& message) {
        const Outcome outcome = run_program(arguments);
        INFO(arguments << "\n" << outcome.err);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Contains(message));
    };
    refused("laminate dataset granite -o x", 2, "granite");
    refused(fmt::format("laminate dataset marble --resins vero-opaque -o {}", folder / "x"), 3, "no resin of role T");
    refused(fmt::format("laminate dataset marble --points 4096 --radius 64 -o {}", folder / "x"), 3, "fewer --points");
    refused(fmt::format("laminate dataset marble --thickness 0mm -o {}", folder / "x"), 3, "thickness");
    refused(fmt::format("laminate factor {} -o {}", folder / "none", folder / "x.json"), 4, "cannot be opened");
    folder.write("text", "no data at all");
    refused(fmt::format("laminate factor {} -o {}", folder / "text", folder / "x.json"), 3,
            "no data set of scattering");
    refused(fmt::format("laminate factor {} -o {}", folder / "text", folder / "x.txt"), 2, "ends in .json");
    refused(fmt::format("laminate factor {} -o {} --max-albedo 2", folder / "text", folder / "x.json"), 2,
            "max-albedo");
    REQUIRE(
        run_program(fmt::format("laminate dataset marble --points 6 --radius 2 --paths 9 -o {} --quiet", folder / "a"))
            .exit_code == 0);
    REQUIRE(
        run_program(fmt::format("laminate dataset marble --points 7 --radius 2 --paths 9 -o {} --quiet", folder / "b"))
            .exit_code == 0);
    refused(fmt::format("laminate factor {} --check {} -o {}", folder / "a", folder / "b", folder / "x.json"), 3,
            "must be of one surface");
    voxtone::io::BssrdfFile one = voxtone::io::read_bssrdf(folder / "a");
    one.channels.wavelengths_nm = {550};
    one.responses.channels.resize(1);
    voxtone::io::write_bssrdf(one, folder / "one");
    refused(fmt::format("laminate factor {} --luminance -o {}", folder / "one", folder / "x.json"), 3,
            "has one channel");
    refused(fmt::format("laminate factor {} --point 6,0 --picture {} -o {}", folder / "a", folder / "p.png",
                        folder / "x.json"),
            2, "outside");
}
