// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many parts in one print: the same by models and by a plan, the same bits as one part alone, and what is wrong with a
// part or its place is one sentence.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"

using namespace voxtone::test;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

const std::string quick = " --iterations 0 --predict none ";

/// All that the printer reads, but for what tells of the job.
std::map<std::string, std::string> layers_in(const std::string& out) {
    std::map<std::string, std::string> files;
    for (auto& [name, bytes] : read_tree(out))
        if (name.starts_with("layers/")) files.emplace(name, std::move(bytes));
    return files;
}

json read_json(const std::string& file) { return json::parse(read_file(file)); }

/// A folder with models and a plan of them.
struct Bench {
    explicit Bench(const std::string& name) : folder(name) {
        folder.write("marker.obj", marker_obj());
        folder.write("ramp.obj", ramp_box_obj(5, 3, 3));
    }
    /// `parts`: what the plan lists; `more`: words beside them.
    [[nodiscard]] Outcome tray(const std::string& parts, const std::string& options = "",
                               const std::string& more = "") const {
        folder.write("tray.json",
                     R"({"format": "voxtone-tray", "version": 1, )" + more + R"("parts": [)" + parts + "]}");
        return run_program("slice " + (folder / "tray.json") + quick + options + " -o " + (folder / "out"));
    }
    Folder folder;
};

}  // namespace

TEST_CASE("Several models are a tray, one is the print that it would be alone") {
    const Bench bench("many");
    const std::string marker = bench.folder / "marker.obj", ramp = bench.folder / "ramp.obj";
    REQUIRE(run_program("slice " + marker + " " + ramp + quick + "-o " + (bench.folder / "a")).exit_code == 0);
    REQUIRE(run_program("tray " + marker + " " + ramp + quick + "-o " + (bench.folder / "b")).exit_code == 0);
    REQUIRE(bench.tray(R"({"model": "marker.obj"}, {"model": "ramp.obj"})").exit_code == 0);
    CHECK(layers_in(bench.folder / "a").size() > 50);
    CHECK(layers_in(bench.folder / "a") == layers_in(bench.folder / "b"));
    CHECK(layers_in(bench.folder / "a") == layers_in(bench.folder / "out"));
    const json tray = read_json(bench.folder / "a/tray.json");
    REQUIRE(tray["parts"].size() == 2);
    CHECK(tray["parts"][0]["name"] == "marker");
    CHECK(tray["failed"].empty());
    CHECK(voxtone::io::schema_faults("tray-stack", tray.dump()) == std::vector<std::string>{});
    CHECK(run_program("verify --quiet " + (bench.folder / "a")).exit_code == 0);
    // The same again does nothing, another tray in its place is refused.
    CHECK_THAT(run_program("slice " + marker + " " + ramp + quick + "-o " + (bench.folder / "a")).out,
               Contains("nothing was done"));
    CHECK(run_program("slice " + ramp + " " + marker + quick + "-o " + (bench.folder / "a")).exit_code == 3);

    REQUIRE(run_program("tray " + marker + quick + "-o " + (bench.folder / "one")).exit_code == 0);
    REQUIRE(run_program("slice " + marker + quick + "-o " + (bench.folder / "alone")).exit_code == 0);
    CHECK(layers_in(bench.folder / "one") == layers_in(bench.folder / "alone"));
    CHECK(read_json(bench.folder / "one/manifest.json")["content_sha256"] ==
          read_json(bench.folder / "alone/manifest.json")["content_sha256"]);
}

TEST_CASE("A part that fails is left out and told of, --fail-fast stops there") {
    const Bench bench("fails");
    const std::string parts = R"({"model": "marker.obj"}, {"model": "gone.obj", "name": "gone"})";
    const Outcome fast = bench.tray(parts, "--fail-fast");
    CHECK(fast.exit_code == 4);
    CHECK_THAT(fast.err, Contains("parts[1]") && Contains("gone.obj"));
    CHECK_FALSE(fs::exists(bench.folder / "out/manifest.json"));

    const Outcome rest = bench.tray(parts);
    CHECK(rest.exit_code == 4);
    CHECK_THAT(rest.err, Contains("gone: fails, and the tray is made without it"));
    const json tray = read_json(bench.folder / "out/tray.json");
    REQUIRE(tray["parts"].size() == 1);
    CHECK(tray["parts"][0]["name"] == "marker");
    REQUIRE(tray["failed"].size() == 1);
    CHECK(tray["failed"][0]["name"] == "gone");
    CHECK(tray["failed"][0]["exit_code"] == 4);
    CHECK(run_program("verify --quiet " + (bench.folder / "out")).exit_code == 0);

    // Once it is mended the same command makes the whole tray.
    bench.folder.write("gone.obj", ramp_box_obj(3, 3, 3));
    CHECK(bench.tray(parts).exit_code == 0);
    CHECK(read_json(bench.folder / "out/tray.json")["parts"].size() == 2);
}

TEST_CASE("A print that will not look as asked is no success of a strict tray") {
    const Bench bench("strict");
    const std::string words = "slice " + (bench.folder / "ramp.obj") + " " + (bench.folder / "ramp.obj") +
                              " --size 3mm --iterations 0 --verdict-good 1e-6 --verdict-bad 1e-5 -o " +
                              (bench.folder / "out");
    CHECK(run_program(words).exit_code == 0);
    CHECK(run_program(words + " --strict").exit_code == 6);  // as it was made
    CHECK(run_program(words + " --strict --overwrite").exit_code == 6);
}

TEST_CASE("What is odd about places is said, what cannot be is refused") {
    const Bench bench("places");
    // A third of a millimetre is no whole number of voxels.
    const Outcome moved = bench.tray(R"({"model": "marker.obj", "at": [0.33, 0.33]})");
    CHECK(moved.exit_code == 0);
    CHECK_THAT(moved.err, Contains("marker: lies up to") && Contains("whole voxels"));
    const Outcome exact = bench.tray(R"({"model": "marker.obj", "at": [0, 0]})", "--overwrite");
    CHECK_THAT(exact.err, !Contains("whole voxels"));

    // Parts of one look are joined and share; of others one has what both fill.
    const std::string both =
        R"({"model": "marker.obj", "at": [0, 0]}, {"model": "ramp.obj", "depth": "0.8mm", "at": [1, 1])";
    const Outcome joined =
        bench.tray(R"({"model": "marker.obj", "at": [0, 0]}, {"model": "ramp.obj", "at": [1, 1]})", "--overwrite");
    CHECK_THAT(joined.err, Contains("are in more than one of them"));
    const Outcome equal = bench.tray(both + "}", "--overwrite");
    CHECK(equal.exit_code == 0);
    CHECK_THAT(equal.err, Contains("marker: ") && Contains("of the same priority"));
    CHECK(read_json(bench.folder / "out/tray.json")["parts"][0]["overlapped_by_equals_mm3"].get<double>() > 1);
    const Outcome higher = bench.tray(both + R"(, "priority": 1})", "--overwrite");
    CHECK_THAT(higher.err, Contains("where another part is printed") && !Contains("of the same priority"));

    const Outcome high = bench.tray(R"({"model": "marker.obj", "at": [0, 0, 199]})", "--overwrite");
    CHECK(high.exit_code == 3);
    CHECK_THAT(high.err, Contains("parts[0]") && Contains("along z") && Contains("built up to"));
    const Outcome off = bench.tray(R"({"model": "marker.obj", "at": [489, 0]})", "--overwrite");
    CHECK(off.exit_code == 3);
    CHECK_THAT(off.err, Contains("along x"));
}

TEST_CASE("A tray makes nothing in a strange folder") {
    const Bench bench("strange");
    fs::create_directory(bench.folder / "out");
    bench.folder.write("out/letter.txt", "dear");
    const Outcome refused = bench.tray(R"({"model": "marker.obj"})");
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("letter.txt"));
    const Outcome several = run_program("slice " + (bench.folder / "marker.obj") + " " + (bench.folder / "ramp.obj") +
                                        quick + "-o " + (bench.folder / "out"));
    CHECK(several.exit_code == 3);
    CHECK(read_tree(bench.folder / "out").size() == 1);
}

TEST_CASE("What is for many parts is refused for one, and the other way round") {
    const Bench bench("scope");
    const std::string out = " -o " + (bench.folder / "out"), marker = bench.folder / "marker.obj";
    for (const char* option : {"--gap 2mm", "--arrange none", "--trays 2", "--turn", "--fail-fast"}) {
        CAPTURE(option);
        const Outcome one = run_program("slice " + marker + " " + option + out);
        CHECK(one.exit_code == 2);
        CHECK_THAT(one.err, Contains("many parts"));
    }
    const std::string two = "slice " + marker + " " + (bench.folder / "ramp.obj") + out;
    CHECK(run_program(two + " --layers 0-5").exit_code == 2);
    CHECK(run_program(two + " --mixtures x").exit_code == 2);
    const Outcome plan_beside = run_program("slice " + marker + " tray.json" + out);
    CHECK(plan_beside.exit_code == 2);
    CHECK_THAT(plan_beside.err, Contains("tray.json") && Contains("names its parts itself"));
    CHECK_FALSE(fs::exists(bench.folder / "out/manifest.json"));
}

TEST_CASE("What finds no room on the plate goes over it, or onto the next tray, or is named") {
    const Bench bench("room");
    // 490 x 390 mm hold three times three of 150 x 120 mm.
    bench.folder.write("flat.obj", ramp_box_obj(150, 120, 1.7));
    const std::string parts = R"({"model": "flat.obj", "name": "flat", "copies": 11})";
    const Outcome full = bench.tray(parts);
    CHECK(full.exit_code == 3);
    CHECK_THAT(full.err, Contains("2 of flat") && Contains("--trays") && Contains("--arrange stacked"));
    CHECK_FALSE(fs::exists(bench.folder / "out/manifest.json"));

    REQUIRE(bench.tray(parts, "--trays 2").exit_code == 0);
    const json first = read_json(bench.folder / "out/tray.json"), second = read_json(bench.folder / "out-2/tray.json");
    CHECK(first["parts"][0]["at_px"].size() == 9);
    CHECK(second["parts"][0]["at_px"].size() == 2);
    CHECK(second["tray"] == 2);
    CHECK(run_program("verify --quiet " + (bench.folder / "out-2")).exit_code == 0);

    REQUIRE(bench.tray(parts, "--arrange stacked --overwrite").exit_code == 0);
    const json stacked = read_json(bench.folder / "out/tray.json");
    std::set<int> levels;
    for (const json& at : stacked["parts"][0]["at_px"]) levels.insert(at[2].get<int>());
    CHECK(stacked["parts"][0]["at_px"].size() == 11);
    REQUIRE(levels.size() == 2);
    CHECK(*levels.rbegin() * 0.027 >= 1.7 + 2);  // above the first level with the gap between
}
