// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/core.h>
#include <png.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/profiles/profile_file.h"
#include "io/profiles/profile_map.h"

#include "run_program.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

/// Falls off exponentially: total / (2 pi s^2) exp(-r / s).
optics::RadialSamples profile(double total, double s_mm) {
    optics::RadialSamples samples;
    samples.spacing_mm = 0.1;
    for (int i = 0; i <= 60; ++i)
        samples.light.push_back(total / (2 * std::numbers::pi * s_mm * s_mm) * std::exp(-0.1 * i / s_mm));
    return samples;
}

/// 6 x 2 mm: dark and narrow on the left, bright and wide on the right, one pixel a mm.
io::ProfileMap two_halves() {
    io::ProfileMap map;
    map.source = "test";
    map.width_mm = 6, map.height_mm = 2;
    map.width_px = 6, map.height_px = 2;
    for (int p = 0; p < 12; ++p) map.cluster.push_back(p % 6 >= 3);
    map.target = {{3, profile(0.1, 0.2)}, {3, profile(0.5, 0.5)}};
    return map;
}

std::string write_map(const Folder& folder, const io::ProfileMap& map = two_halves(),
                      const std::string& name = "map.json") {
    io::write_profile_map(map, folder / name);
    return folder / name;
}

/// The slab of the map's own picture, 1 mm thick.
std::string slab_job(const Folder& folder, const std::string& map) {
    return fmt::format(
        "slice --load W,K --laminate-thickness 0.6mm --laminate-steps 16 --thickness 1.08mm --show "
        "layered-profile "
        "--profiles {} {}",
        map, folder / "map.png");
}

std::string box_obj() {
    return "v 0 0 0\nv 3 0 0\nv 0 2 0\nv 3 2 0\nv 0 0 2\nv 3 0 2\nv 0 2 2\nv 3 2 2\n"
           "f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\nf 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 8 "
           "6\n";
}

bool is_dark(const std::array<std::uint8_t, 4>& pixel) { return pixel[0] < 100; }

}  // namespace

TEST_CASE("slice prints layered profiles on a slab as wide as the map, with a report of its stacks") {
    const Folder folder("layered");
    const Outcome outcome = run_program(slab_job(folder, write_map(folder)) + " -o " + (folder / "out"));
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(outcome.out, Contains("2 profiles by"));
    CHECK(run_program("verify --quiet " + (folder / "out")).exit_code == 0);

    const auto report = nlohmann::json::parse(read_file(folder / "out/report.json"));
    CHECK(report["size_mm"][0].get<double>() == Approx(6));
    CHECK(report["layers"] == 40);
    CHECK_FALSE(report.contains("gamut"));
    CHECK(report["job"]["show"] == "layered-profile");
    CHECK(report["sections"][0]["title"] == "Scattering profiles");
    const auto& clusters = report["sections"][0]["tables"][0]["rows"];
    REQUIRE(clusters.size() == 2);
    for (const auto& row : clusters) CHECK(row[1] == "50.0 %");
    CHECK(read_file(folder / "out/report.html").find("<polyline") != std::string::npos);
    const Bitmap target = read_png(folder / "out/target.png");
    CHECK(target.at(5, 5)[0] < target.at(target.width - 5, 5)[0]);

    // Bright needs more white above the black base: at half of the stacks' depth the left is the darker one.
    int dark_left = 0, dark_right = 0;
    for (int layer = 18; layer < 40; ++layer) {
        const Bitmap bitmap = read_png(folder / fmt::format("out/layers/slice_{:05}.png", layer));
        for (int y = 0; y < bitmap.height; ++y) {
            dark_left += is_dark(bitmap.at(bitmap.width / 4, y));
            dark_right += is_dark(bitmap.at(3 * bitmap.width / 4, y));
        }
    }
    CHECK(dark_left > dark_right);
}

TEST_CASE("laminate trace sees in a print's voxels what its laminates were traced to show, on any number of threads") {
    const Folder folder("layered-trace");
    io::ProfileMap map = two_halves();
    map.width_mm = map.width_px = 20, map.height_mm = map.height_px = 12;
    map.cluster.assign(240, 0);
    for (std::size_t p = 0; p < 240; ++p) map.cluster[p] = p % 20 >= 10;
    map.target = {{3, profile(0.2, 0.3)}, {3, profile(0.5, 0.3)}};
    for (auto& target : map.target)
        for (optics::RadialSamples& samples : target) samples.light.resize(31);  // 3 pixels
    const std::string file = write_map(folder, map);
    REQUIRE(run_program(slab_job(folder, file) + " --quiet -o " + (folder / "out")).exit_code == 0);
    const auto report = nlohmann::json::parse(read_file(folder / "out/report.json"));
    std::map<int, double> reached;  // by cluster, red
    for (const auto& row : report["sections"][0]["tables"][0]["rows"])
        reached[std::stoi(row[0].get<std::string>())] = std::stod(row[5].get<std::string>());
    CHECK(reached.at(1) - reached.at(0) > 0.05);
    std::vector<nlohmann::json> traced;
    for (const char* threads : {"1", "3"}) {
        const Outcome outcome =
            run_program(fmt::format("laminate trace {} --paths 500 --threads {} --quiet --json -o {}", folder / "out",
                                    threads, folder / fmt::format("{}.png", threads)));
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        const std::size_t last = outcome.out.rfind('\n', outcome.out.size() - 2);
        traced.push_back(
            nlohmann::json::parse(outcome.out.substr(last == std::string::npos ? 0 : last + 1)).at("result"));
        traced.back().erase("seconds");
    }
    CHECK(traced[0] == traced[1]);
    // The report has traced it, too.
    const auto spread = std::find_if(report["sections"].begin(), report["sections"].end(), [](const auto& section) {
        return section["title"] == "How light spreads in the print";
    });
    REQUIRE(spread != report["sections"].end());
    const auto& rows = (*spread)["tables"][0]["rows"];
    REQUIRE(rows.size() == traced[0]["clusters"].size());
    for (std::size_t k = 0; k < rows.size(); ++k)
        CHECK(rows[k][4] == fmt::format("{:.4f}", traced[0]["clusters"][k]["printed"][1]["total"].get<double>()));
    CHECK(read_file(folder / "1.png") == read_file(folder / "3.png"));
    const auto& clusters = traced[0].at("clusters");
    REQUIRE(clusters.size() == 2);
    for (const auto& cluster : clusters) {
        CHECK(cluster.at("places") == 7 * 6);
        CHECK(cluster.at("noise") < 0.01);
        CHECK(cluster.at("printed")[0].at("total").get<double>() ==
              Approx(reached.at(cluster.at("cluster"))).margin(0.03));
        CHECK(cluster.at("clustered")[0].at("total").get<double>() ==
              Approx(cluster.at("cluster") == 1 ? 0.5 : 0.2).margin(0.03));
    }
    const auto fails = [&](const std::string& more, int exit_code, const std::string& words) {
        const Outcome failed = run_program("laminate trace --quiet " + more);
        INFO(more << ": " << failed.err);
        CHECK(failed.exit_code == exit_code);
        CHECK_THAT(failed.err, Contains(words));
    };
    fails((folder / "out") + " -o x.jpg", 2, "as .png, .svg or .bssrdf");
    fails(folder / "none", 3, "--show layered-profile");
    fails((folder / "out") + " --profiles " + write_map(folder, two_halves(), "small.json"), 3, "map's own size");
    fails((folder / "out") + " --dataset " + file, 3, "no data set");
    folder.write("box.obj", box_obj());
    REQUIRE(
        run_program(fmt::format("slice --quiet --no-report --load W,K --laminate-thickness 0.6mm --laminate-steps 16 "
                                "--laminate-rounds 0 --profile-placement box --show layered-profile --profiles {} {} "
                                "-o {}",
                                file, folder / "box.obj", folder / "body"))
            .exit_code == 0);
    fails(folder / "body", 3, "is a body");
}

TEST_CASE("Layered profiles are the same for any number of threads and from the job file that they leave") {
    const Folder folder("layered-threads");
    folder.write("box.obj", box_obj());
    const std::string job = fmt::format(
        "slice --quiet --no-report --load W,K --laminate-thickness 0.6mm --laminate-steps 16 --profile-placement box "
        "--surfaces "
        "--show layered-profile --profiles {} {}",
        write_map(folder), folder / "box.obj");
    REQUIRE(run_program(job + " --threads 1 -o " + (folder / "one")).exit_code == 0);
    REQUIRE(run_program(job + " --threads 4 -o " + (folder / "four")).exit_code == 0);
    REQUIRE(
        run_program(fmt::format("slice --quiet --job {} -o {}", folder / "one/job.json", folder / "again")).exit_code ==
        0);
    const auto of = [&](const std::string& name) {
        auto tree = read_tree(folder.path() / name);
        std::erase_if(tree, [](const auto& file) { return file.first == "report.json" || file.first == "job.json"; });
        return tree;
    };
    CHECK(of("one").size() > 70);
    CHECK(of("one") == of("four"));
    CHECK(of("one") == of("again"));
    CHECK(std::filesystem::file_size(folder.path() / "one/surfaces/W.ply") > 1000);
}

TEST_CASE("slice arranges resins that are known by measured profiles, and says where they do not fit") {
    const Folder folder("layered-measured");
    const std::string map = write_map(folder);
    for (const auto& [role, R, T] : {std::tuple{"white", 0.6, 0.3}, {"black", 0.02, 0.05}}) {
        io::ProfileFile file{role, "test", {}, {3, {0.3, profile(T, 0.5), profile(R, 0.3)}}};
        folder.write(fmt::format("{}.json", role), io::profile_text(file));
    }
    const std::string job =
        slab_job(folder, map) + fmt::format(" --laminate-materials W={},K={} -o {}", folder / "white.json",
                                            folder / "black.json", folder / "out");
    const Outcome done = run_program(job);
    INFO(done.err);
    REQUIRE(done.exit_code == 0);
    CHECK_THAT(read_file(folder / "out/report.html"),
               Contains("from measured layers") && Contains("nothing else is known"));
    const auto warnings = [&] {
        return nlohmann::json::parse(read_file(folder / "out/report.json"))["warnings"].dump();
    };
    CHECK_THAT(warnings(), !Contains("stretched") && !Contains("too thin"));
    folder.write("square.ppm", "P6\n2 2\n255\n" + std::string(12, 'x'));
    const Outcome other = run_program(fmt::format(
        "slice --quiet --overwrite --load W,K --laminate-thickness 0.6mm --laminate-steps 16 --show layered-profile "
        "--profiles {} --laminate-materials W={},K={} {} --width 3mm --thickness 0.3mm --printer generic -o {}",
        map, folder / "white.json", folder / "black.json", folder / "square.ppm", folder / "out"));
    INFO(other.err);
    REQUIRE(other.exit_code == 0);
    CHECK_THAT(warnings(), Contains("(6 x 2 mm) is stretched onto a picture of another shape (3 x 3 mm)"));
    CHECK_THAT(warnings(), Contains("[stretched-map]"));
    CHECK_THAT(warnings(), Contains("too thin for its laminate") && Contains("[thin-laminate]"));
    const auto fails = [&](const std::string& more, int exit_code, const std::string& words) {
        const Outcome failed = run_program(slab_job(folder, map) + " --overwrite " + more + " -o " + (folder / "out"));
        INFO(more << ": " << failed.err);
        CHECK(failed.exit_code == exit_code);
        CHECK_THAT(failed.err, Contains(words));
    };
    const std::string white = folder / "white.json";
    fails("--laminate-materials W=" + white, 3, "the loaded resin K has no profile");
    fails("--laminate-materials W=" + white + ",C=" + white, 3, "no resin of this role");
    fails("--laminate-materials W=" + white + ",K=none.json", 4, "none.json");
    fails("--laminate-materials W=" + white + ",W=" + white, 2, "twice");
    fails("--laminate-materials W", 2, "ROLE=FILE");
    fails("--laminate-rounds 2 --laminate-materials W=" + white, 2, "--laminate-rounds");
    fails("--laminate-rounds 21", 2, "0 to 20");
    fails("--laminate-rounds some", 2, "--laminate-rounds");
    io::ProfileFile one{"one", "test", {{550}}, {{0.3, profile(0.1, 0.5), profile(0.5, 0.3)}}};
    folder.write("one.json", io::profile_text(one));
    fails("--laminate-materials W=" + white + ",K=" + (folder / "one.json"), 3, "one.json");
    one.name = "two";
    folder.write("two.json", io::profile_text(one));
    fails("--laminate-materials W=" + (folder / "two.json") + ",K=" + (folder / "one.json"), 3, "channel by channel");
}

TEST_CASE("slice says what is wrong with a job of layered profiles") {
    const Folder folder("layered-errors");
    const std::string map = write_map(folder), out = " -o " + (folder / "out");
    folder.write("box.obj", box_obj());
    const auto fails = [&](const std::string& arguments, int code, const std::string& text) {
        const Outcome outcome = run_program("slice --quiet " + arguments + out);
        INFO(arguments);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Contains(text));
        CHECK_FALSE(std::filesystem::exists(folder.path() / "out/manifest.json"));
    };
    const std::string box = folder / "box.obj", layered = box + " --show layered-profile --profiles ";
    fails(box + " --show layered-profile", 2, "needs a map of profiles");
    fails(box + " --show layered", 2, "--show: 'layered' is none of colour, layered-profile");
    fails(box + " --profiles " + map, 2, "only goes with --show layered-profile");
    fails(layered + (folder / "none.json"), 4, "none.json");
    fails(layered + map, 3, "--profile-placement box");
    fails(layered + map + " --profile-placement box --load K", 3, "only one resin");
    fails(layered + map + " --profile-placement box --load W,Y", 3, "--base K");
    fails(layered + map + " --profile-placement box --size 0.09mm --printer generic", 3, "voxels thick");
    fails(layered + map + " --laminate-thickness 0mm", 2, "--laminate-thickness");
    fails(layered + map + " --profile-placement box --clear-top T=0.2mm", 3, "--clear-top T");
    fails(layered + map + " --clear-top W", 2, "ROLE=LENGTH");

    io::ProfileMap spectral = two_halves();
    spectral.channels.wavelengths_nm = {450, 550, 650};
    fails(layered + write_map(folder, spectral, "spectral.json") + " --profile-placement box", 3, "3 wavelengths");
    io::ProfileMap bright = two_halves();
    bright.target[1][2] = profile(1.5, 0.5);
    fails(layered + write_map(folder, bright, "bright.json") + " --profile-placement box", 3, "cluster 1, channel 2");
    io::ProfileMap none = two_halves();
    nlohmann::json text = nlohmann::json::parse(read_file(map));
    text["clusters"] = nlohmann::json::array();
    folder.write("empty.json", text.dump());
    fails(layered + (folder / "empty.json"), 3, "clusters");
}
