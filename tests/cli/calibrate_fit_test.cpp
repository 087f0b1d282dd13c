// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "calibration/patches/patch_file.h"
#include "io/profiles/resin_file.h"
#include "optics/colour/colour.h"
#include "optics/layered/flat_colour.h"
#include "run_program.h"
#include "tests/calibration/patches/target_samples.h"

using namespace voxtone;
using namespace voxtone::test;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

PatchTable measured(double noise) {
    PatchTable table = calibration::testing::target('B', {"C", "M", "Y"});
    calibration::testing::measure(table, optics::vero_opaque(), noise, 3);
    if (noise > 0)
        for (Patch& patch : table.patches) patch.error.assign(3, noise);
    return table;
}

}  // namespace

TEST_CASE("calibrate fit makes a resin set of patches that slice can use, and calibrate check says how good it is") {
    const Folder folder("calibrate_fit");
    folder.write("patches.csv", patch_table_text(measured(0), "target B"));
    const Outcome fit = run_program(
        fmt::format("calibrate fit {} --resins C,M,Y,K,W -o {}", folder / "patches.csv", folder / "my.json"));
    INFO(fit.err);
    REQUIRE(fit.exit_code == 0);
    CHECK_THAT(fit.err, Contains("mixtures are taken as ideal") && Contains("[ideal-mixtures]"));
    CHECK_THAT(fit.out, Contains("CIEDE2000 of 20 patches") && Contains("reduced extinction"));
    const optics::ResinSet set = io::read_resin_set(folder / "my.json");
    CHECK(set.name == "my");
    CHECK(set.dot_spread == 1);  // ideal, as they were taken
    const optics::ResinSet truth = optics::vero_opaque();
    for (const auto& resin : truth.resins)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& found = set.resins[static_cast<std::size_t>(set.find(resin.role))];
            CHECK(found.albedo[c] == Approx(resin.albedo[c]).epsilon(1e-3));
            CHECK(found.sigma_t_per_mm[c] == Approx(resin.sigma_t_per_mm[c]).epsilon(1e-3));
        }
    const auto details = nlohmann::json::parse(read_file(folder / "my.fit.json"));
    CHECK(details.at("format") == "voxtone-fit");
    CHECK(details.at("resins").size() == 5);
    CHECK(details.at("resins")[0].at("channels")[0].at("sigma_t_per_mm").at("standard_error") > 0);

    folder.write("noisy.csv", patch_table_text(measured(0.005)));
    const Outcome check =
        run_program(fmt::format("calibrate check {} {} --json", folder / "my.json", folder / "noisy.csv"));
    REQUIRE(check.exit_code == 0);
    CHECK_THAT(check.out + check.err, Contains("mixtures are taken as ideal"));
    CHECK_THAT(check.out, Contains("voxtone-check") && Contains("mean_de2000"));

    folder.write("marker.obj", marker_obj());
    const Outcome slice = run_program(fmt::format("slice --quiet --no-report --iterations 0 {} --resins {} -o {}",
                                                  folder / "marker.obj", folder / "my.json", folder / "out"));
    INFO(slice.err);
    CHECK(slice.exit_code == 0);
}

TEST_CASE(
    "calibrate fit with --json gives one object a line, the same for any number of threads, with a sweep over g") {
    const Folder folder("calibrate_json");
    folder.write("patches.csv", patch_table_text(measured(0.005)));
    const auto values = [&](int threads) {
        const Outcome fit =
            run_program(fmt::format("calibrate fit {} -o {} --overwrite --json --g-sweep --check {} --threads {}",
                                    folder / "patches.csv", folder / "my.json", folder / "patches.csv", threads));
        REQUIRE(fit.exit_code == 0);
        const auto from = fit.out.rfind('\n', fit.out.size() - 2);
        auto line = nlohmann::json::parse(fit.out.substr(from == std::string::npos ? 0 : from + 1));
        return line.contains("result") ? line.at("result") : line;
    };
    const auto one = values(1), two = values(2);
    CHECK(one.at("resins") == two.at("resins"));
    CHECK(one.at("g_sweep").size() == 19);
    CHECK(one.at("check").at("patches").at("list").size() == 20);
}

TEST_CASE("calibrate fit finds a printer's dot spread in a target's squares, unless it is given") {
    const Folder folder("calibrate_spread");
    PatchTable table = calibration::testing::target('C', {"C", "M", "Y"});
    PatchModelOptions printed;
    printed.pitch_mm = {0.04233, 0.08467, 0.027};
    printed.dot_spread = 1;
    calibration::testing::measure(table, optics::vero_opaque(), 0.0005, 3, printed);
    folder.write("patches.csv", patch_table_text(table));
    const auto fit = [&](const std::string& more) {
        const Outcome outcome =
            run_program(fmt::format("calibrate fit {} --pitch 42.33,84.67,27um --noise {} --overwrite -o {}",
                                    folder / "patches.csv", more, folder / "my.json"));
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return outcome;
    };
    const Outcome found = fit("0.0005");
    CHECK_THAT(found.out, Contains("Dot spread "));
    const auto details = nlohmann::json::parse(read_file(folder / "my.fit.json")).at("dot_spread");
    CHECK(details.at("error") > 0);
    CHECK(io::read_resin_set(folder / "my.json").dot_spread == Approx(1).margin(3 * details.at("error").get<double>()));
    CHECK_THAT(fit("0.0005 --dot-spread 0").out, !Contains("Dot spread "));
    CHECK(io::read_resin_set(folder / "my.json").dot_spread == 0);
    CHECK_THAT(fit("0.1").err, Contains("cannot be told"));
}

TEST_CASE("calibrate fit refuses what it cannot use, with the exit code of its kind") {
    const Folder folder("calibrate_faults");
    const std::string good = patch_table_text(measured(0));
    folder.write("good.csv", good);
    folder.write("empty.csv", "");
    folder.write("negative.csv", "top,backing,thickness_mm,R,G,B\nW,W,0.675,0.8,-0.2,0.8\n");
    const auto fit = [&](const std::string& more) {
        return run_program(fmt::format("calibrate fit {} -o {}", more, folder / "x.json"));
    };
    const auto fails = [&](const std::string& more, int code, const std::string& with) {
        const Outcome outcome = fit(more);
        INFO(more << ": " << outcome.err);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Contains(with));
        CHECK_FALSE(std::filesystem::exists(folder / "x.json"));
    };
    fails(folder / "nothing.csv", 4, "nothing.csv");
    fails(folder / "empty.csv", 3, "no header");
    fails(folder / "negative.csv", 3, "W on W");
    fails(folder / "good.csv --resins C,M,Y,K,W,O", 3, "resin O has no patch");
    fails(folder / "good.csv --g 1.5", 3, "g is 1.5");
    fails(folder / "good.csv --dot-spread 0.5", 2, "--printer or --pitch");
    fails(folder / "good.csv --printer stratasys-j750-hm --pitch 1,1,1mm", 2, "--pitch");
    const Outcome check = run_program(fmt::format("calibrate check nowhere {}", folder / "good.csv"));
    CHECK(check.exit_code == 3);
}

namespace {

// Vero as edges might have found it, each extinction too large by a part of its error.
std::string edge_results() {
    const optics::ResinSet set = optics::vero_opaque();
    nlohmann::ordered_json resins = nlohmann::ordered_json::array();
    for (const auto& resin : set.resins) {
        nlohmann::ordered_json channels = nlohmann::ordered_json::array();
        for (std::size_t c = 0; c < 3; ++c)
            channels.push_back(
                {{"channel", std::string(1, "RGB"[c])},
                 {"sigma_t_per_mm", {{"value", 1.01 * resin.sigma_t_per_mm[c]}, {"doubts", nlohmann::json::array()}}},
                 {"albedo", {{"value", resin.albedo[c]}, {"doubts", nlohmann::json::array()}}},
                 {"covariance_v_ln_sigma_t", {1.6e-5, 0, 4e-4}}});
        resins.push_back({{"role", resin.role}, {"channels", channels}});
    }
    return nlohmann::ordered_json{
        {"format", "voxtone-edge-fit"}, {"version", 1}, {"g", 0.4}, {"eta", 1.5}, {"resins", resins}}
        .dump();
}

// Summed squares of ln(extinction / truth).
double extinctions_off(const std::string& file) {
    const optics::ResinSet truth = optics::vero_opaque(), set = io::read_resin_set(file);
    double sum = 0;
    for (const auto& resin : truth.resins)
        for (std::size_t c = 0; c < 3; ++c)
            sum += std::pow(std::log(set.resins[static_cast<std::size_t>(set.find(resin.role))].sigma_t_per_mm[c] /
                                     resin.sigma_t_per_mm[c]),
                            2);
    return sum;
}

}  // namespace

TEST_CASE("calibrate fit takes what edges found as a prior, with their g") {
    const Folder folder("calibrate_prior");
    folder.write("patches.csv", patch_table_text(measured(0.005)));
    folder.write("my.edge.json", edge_results());
    const auto fit = [&](const std::string& more, const std::string& out) {
        return run_program(fmt::format("calibrate fit {} {} -o {}", folder / "patches.csv", more, folder / out));
    };
    REQUIRE(fit("", "patches.json").exit_code == 0);
    const Outcome joined = fit("--prior " + (folder / "my.edge.json"), "joined.json");
    INFO(joined.err);
    REQUIRE(joined.exit_code == 0);
    CHECK(extinctions_off(folder / "joined.json") < 0.5 * extinctions_off(folder / "patches.json"));
    CHECK_THAT(io::read_resin_set(folder / "joined.json").source, Contains("my.edge.json"));

    const auto refused = [&](const std::string& more, int code, const std::string& with) {
        const Outcome outcome = fit(more, "x.json");
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Contains(with));
    };
    refused("--g 0.5 --prior " + (folder / "my.edge.json"), 2, "--g");
    refused("--g-sweep --prior " + (folder / "my.edge.json"), 2, "--g-sweep with --prior");
    refused("--prior " + (folder / "nothing.edge.json"), 4, "nothing.edge.json");
    refused("--prior " + (folder / "joined.json"), 3, "voxtone-edge-fit");
}

TEST_CASE("calibrate fit takes what edges found beside a chart of mixtures") {
    const Folder folder("calibrate_chart_prior");
    folder.write("my.edge.json", edge_results());
    std::string text = "C,M,Y,W,R,G,B\n";
    const optics::ResinSet vero = optics::vero_opaque();
    const optics::FlatColour flat(vero);
    for (int i = 0; i < 40; ++i) {
        // Shares of five resins by a rank-one lattice; every fourth mixture is a resin alone or half of it with white.
        std::vector<double> shares(vero.resins.size());
        for (const std::string role : {"C", "M", "Y"})
            shares[static_cast<std::size_t>(vero.find(role))] =
                i < 8 ? (std::string("CMYCMYWW")[static_cast<std::size_t>(i)] == role[0] ? (i < 3 ? 1.0 : 0.5) : 0.0)
                      : std::fmod(0.05 + i * (role == "C"   ? 0.245
                                              : role == "M" ? 0.570
                                                            : 0.755),
                                  1.0) /
                            3;
        double sum = 0;
        for (const double share : shares) sum += share;
        shares[static_cast<std::size_t>(vero.find("W"))] = 1 - sum;
        const Eigen::Vector3d rgb = optics::linear_srgb_from_xyz(flat.xyz(shares));
        text += fmt::format("{},{},{},{},{},{},{}\n", shares[static_cast<std::size_t>(vero.find("C"))],
                            shares[static_cast<std::size_t>(vero.find("M"))],
                            shares[static_cast<std::size_t>(vero.find("Y"))],
                            shares[static_cast<std::size_t>(vero.find("W"))], rgb[0], rgb[1], rgb[2]);
    }
    folder.write("chart.csv", text);
    const Outcome joined =
        run_program(fmt::format("calibrate fit {} --channels 3 --prior {} -o {}", folder / "chart.csv",
                                folder / "my.edge.json", folder / "joined.json"));
    INFO(joined.err);
    REQUIRE(joined.exit_code == 0);
    CHECK_THAT(joined.out, Contains("White scatters"));
    CHECK_THAT(io::read_resin_set(folder / "joined.json").source, Contains("my.edge.json"));
}

TEST_CASE("calibrate edge chart prints all equal mixtures, and edge fit wants the voxels with its patches") {
    const Folder folder("edge_chart");
    const Outcome chart = run_program(fmt::format("calibrate edge chart --resins W,K,C -o {}", folder / "chart"));
    INFO(chart.err);
    REQUIRE(chart.exit_code == 0);
    const auto target = nlohmann::json::parse(read_file(folder / "chart/target.json"));
    CHECK(target.at("layout") == "E");
    CHECK(target.at("squares").size() == 14);
    const Outcome fit =
        run_program(fmt::format("calibrate edge fit x.csv --printer stratasys-j750-hm -o {}", folder / "x.json"));
    CHECK(fit.exit_code == 2);
    CHECK_THAT(fit.err, Contains("--chart"));
}
