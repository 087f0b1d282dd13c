// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many parts in one print, as a user meets them. Where parts come to stand, and which voxels they have there, is
// tested without the program (tests/slicer/plate).
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <random>
#include <set>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/places.h"

using namespace voxtone::test;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

const std::string quick = " --iterations 0 --predict none ", bare = quick + "--no-report ";

/// All that the printer reads, but for what tells of the job.
std::map<std::string, std::string> layers_in(const std::string& out) {
    std::map<std::string, std::string> files;
    for (auto& [name, bytes] : read_tree(out))
        if (name.starts_with("layers/")) files.emplace(name, std::move(bytes));
    return files;
}

json read_json(const std::string& file) { return json::parse(read_file(file)); }

/// The last line of --json.
json result_in(const Outcome& outcome) {
    const auto begin = outcome.out.rfind('\n', outcome.out.size() - 2);
    return json::parse(outcome.out.substr(begin == std::string::npos ? 0 : begin + 1))["result"];
}

/// Of whole voxels of the usual printer, red to green along x; coordinates are those of a larger assembly.
std::string voxel_box_obj(std::array<int, 3> low, std::array<int, 3> high, int first_vertex) {
    constexpr std::array pitch_mm{25.4 / 600, 25.4 / 300, 0.027}, corner_mm{7.0, -3.0, 2.0};
    std::string text;
    for (int corner = 0; corner < 8; ++corner) {
        text += "v";
        for (std::size_t axis = 0; axis < 3; ++axis)
            text += fmt::format(" {:.9f}",
                                corner_mm[axis] + pitch_mm[axis] * (corner >> axis & 1 ? high[axis] : low[axis]));
        text += corner & 1 ? " 0 0.5 0\n" : " 0.6 0 0\n";
    }
    for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                          std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
        text += fmt::format("f {} {} {} {}\n", f[0] + first_vertex, f[1] + first_vertex, f[2] + first_vertex,
                            f[3] + first_vertex);
    return text;
}

/// A folder with models and a plan of them.
struct Bench {
    explicit Bench(const std::string& name) : folder(name) {
        folder.write("marker.obj", marker_obj());
        folder.write("ramp.obj", soft_box_obj(2.5, 1.5, 1.5));
    }
    /// `parts`: what the plan lists; `more`: words beside them.
    [[nodiscard]] Outcome tray(const std::string& parts, const std::string& options = "",
                               const std::string& more = "") const {
        folder.write("tray.json",
                     R"({"format": "voxtone-tray", "version": 1, )" + more + R"("parts": [)" + parts + "]}");
        return run_program("slice " + (folder / "tray.json") + bare + options + " -o " + (folder / "out"));
    }
    Folder folder;
};

}  // namespace

TEST_CASE("Several models are a tray, one is the print that it would be alone") {
    const Bench bench("many");
    const std::string marker = bench.folder / "marker.obj", ramp = bench.folder / "ramp.obj";
    const auto sliced =
        run_program("slice " + marker + " " + ramp + quick + "--memory 1500MB -o " + (bench.folder / "a"));
    REQUIRE(sliced.exit_code == 0);
    CHECK(sliced.err.starts_with("2 models become the parts of one tray"));
    REQUIRE(run_program("tray " + marker + " " + ramp + bare + "-o " + (bench.folder / "b")).exit_code == 0);
    REQUIRE(bench.tray(R"({"model": "marker.obj"}, {"model": "ramp.obj"})").exit_code == 0);
    CHECK(layers_in(bench.folder / "a").size() > 50);
    CHECK(layers_in(bench.folder / "a") == layers_in(bench.folder / "b"));
    CHECK(layers_in(bench.folder / "a") == layers_in(bench.folder / "out"));
    const json tray = read_json(bench.folder / "a/tray.json");
    REQUIRE(tray["parts"].size() == 2);
    CHECK(tray["parts"][0]["name"] == "marker");
    CHECK(tray["failed"].empty());
    // All white, and known without a prediction; of a draft in colours there is no verdict on its looks.
    CHECK(tray["parts"][0]["verdict"] == "good");
    CHECK_FALSE(tray["parts"][1].contains("verdict"));
    CHECK(tray["parts"][1]["sentence"].get<std::string>().find("How it will look was not predicted") !=
          std::string::npos);
    CHECK(voxtone::io::schema_faults("tray-stack", tray.dump()) == std::vector<std::string>{});
    CHECK(run_program("verify --quiet " + (bench.folder / "a")).exit_code == 0);
    CHECK(read_file(bench.folder / "a/tray.png").starts_with("\x89PNG"));
    CHECK(read_json(bench.folder / "a/report.json")["title"] == "a");
    CHECK(read_json(bench.folder / "out/report.json")["title"] == "A tray");
    for (const json& part : tray["parts"]) CHECK(fs::exists(bench.folder / ("a/" + part["report"].get<std::string>())));
    // A plan is no picture: it stands free.
    CHECK_THAT(run_program("predict " + (bench.folder / "out") + " -o " + (bench.folder / "seen.ply")).out,
               Contains("nothing under it"));
    // The same again does nothing, another tray in its place is refused.
    CHECK_THAT(run_program("slice " + marker + " " + ramp + quick + "-o " + (bench.folder / "a")).out,
               Contains("nothing was done"));
    CHECK(run_program("slice " + ramp + " " + marker + quick + "-o " + (bench.folder / "a")).exit_code == 3);

    REQUIRE(run_program("tray " + marker + quick + "-o " + (bench.folder / "one")).exit_code == 0);
    REQUIRE(run_program("slice " + marker + quick + "-o " + (bench.folder / "alone")).exit_code == 0);
    // A part of the tray can be looked at alone: it is what it would be alone.
    const auto cells_of = [&](const std::string& stack) {
        const Outcome seen = run_program("predict --json --quiet --view body --cell 0.3mm --overwrite " + stack +
                                         " -o " + (bench.folder / "seen.png"));
        INFO(seen.err);
        REQUIRE(seen.exit_code == 0);
        return json::parse(seen.out.substr(seen.out.rfind("{\"event\":\"result\"")))["result"]["cells"];
    };
    CHECK(cells_of(bench.folder / "a/parts/marker") == cells_of(bench.folder / "alone"));
    CHECK(cells_of(bench.folder / "a") > cells_of(bench.folder / "alone"));
    for (const char* stack : {"a", "a/parts/marker", "a/parts/marker/"}) {
        const Outcome proof = run_program("proof --spp 8 --size 32x24 --overwrite " + (bench.folder / stack) + " -o " +
                                          (bench.folder / "proof.png"));
        INFO(proof.err);
        CHECK(proof.exit_code == 0);
        CHECK_THAT(proof.err, Contains("part of a tray") || Contains("tray of many parts"));
    }
    const Outcome gone = run_program("proof " + (bench.folder / "a/parts/nobody") + " -o " + (bench.folder / "p.png"));
    CHECK(gone.exit_code == 3);
    CHECK_THAT(gone.err, Contains("no such part") || Contains("does not say that such a part"));
    CHECK(layers_in(bench.folder / "one") == layers_in(bench.folder / "alone"));
    CHECK(read_json(bench.folder / "one/manifest.json")["content_sha256"] ==
          read_json(bench.folder / "alone/manifest.json")["content_sha256"]);
    // Its page is the one that the print would have, and there is no other.
    const json of_one = read_json(bench.folder / "one/report.json"),
               of_print = read_json(bench.folder / "alone/report.json");
    for (const char* key : {"title", "resins", "gamut", "size_px"}) {
        CAPTURE(key);
        CHECK(of_one.at(key) == of_print.at(key));
    }
    CHECK(read_json(bench.folder / "one/tray.json")["parts"][0]["report"] == "report.html");
    CHECK(fs::exists(bench.folder / "one/report.html"));
    CHECK_FALSE(fs::exists(bench.folder / "one/parts/marker/report.html"));
}

TEST_CASE("A tray keeps the resins of its plan, and what is made of it later takes them") {
    const Folder folder("tray-resins");
    folder.write("a.obj", voxel_box_obj({0, 0, 0}, {60, 30, 40}, 1));
    const std::string out = folder / "out";
    REQUIRE(run_program("tray " + (folder / "a.obj") + " --copies 2 --resins vero-opaque-clear" + bare + "-o " + out)
                .exit_code == 0);
    CHECK(read_json(out + "/job.json")["resins"] == "vero-opaque-clear");
    // Its proof knows the clear resin, which the printer's own set does not have.
    const Outcome proof = run_program("proof " + out + " --size 32x24 --spp 2 --json -o " + (folder / "p.png"));
    INFO(proof.err);
    CHECK(proof.exit_code == 0);
}

TEST_CASE("Copies are said on the command line, and what left a tray is set aside, not lost or left among its parts") {
    const Bench bench("copies");
    const std::string marker = bench.folder / "marker.obj", ramp = bench.folder / "ramp.obj",
                      out = bench.folder / "out";
    REQUIRE(run_program("slice " + marker + " " + ramp + quick + "--copies 2 -o " + out).exit_code == 0);
    const json two = read_json(out + "/tray.json")["parts"];
    REQUIRE(two.size() == 2);
    for (const json& part : two) CHECK(part["at_px"].size() == 2);
    const std::string page = read_file(out + "/parts/ramp/report.html");
    const Outcome again = run_program("slice " + marker + quick + "--copies 3 --overwrite -o " + out);
    REQUIRE(again.exit_code == 0);
    CHECK_THAT(again.err, Contains("ramp: of an earlier tray, and set aside in "));
    CHECK_FALSE(fs::exists(out + "/parts/ramp"));
    CHECK(read_file(out + "/parts/earlier/ramp/report.html") == page);
    CHECK(read_json(out + "/tray.json")["parts"][0]["at_px"].size() == 3);
    CHECK(run_program("slice " + marker + quick + "--copies 0 --overwrite -o " + out).exit_code == 2);
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
    CHECK_THAT(rest.out,
               Contains("  fails: ") && Contains("gone.obj does not exist"));  // where the others' verdicts are, too
    // Who sees the page alone learns of it, too.
    const json report = read_json(bench.folder / "out/report.json");
    CHECK_THAT(report["verdict"]["sentence"].get<std::string>(), Catch::Matchers::StartsWith("Not on the tray: gone."));
    CHECK_THAT(report["warnings"].dump(), Contains("gone is not on the tray") && Contains("does not exist"));
    CHECK_THAT(read_file(bench.folder / "out/printer/HOW-TO-PRINT.html"), Contains("<b>gone is not in this print</b>"));
    const json tray = read_json(bench.folder / "out/tray.json");
    REQUIRE(tray["parts"].size() == 1);
    CHECK(tray["parts"][0]["name"] == "marker");
    REQUIRE(tray["failed"].size() == 1);
    CHECK(tray["failed"][0]["name"] == "gone");
    CHECK(tray["failed"][0]["exit_code"] == 4);
    CHECK(run_program("verify --quiet " + (bench.folder / "out")).exit_code == 0);
    // Quietly the warning is all that is said.
    const Outcome quiet = bench.tray(parts, "--quiet --overwrite");
    CHECK(quiet.exit_code == 4);
    CHECK(quiet.out.empty());
    CHECK_THAT(quiet.err, Contains("gone: fails, and the tray is made without it"));

    // Once it is mended the same command makes the whole tray.
    bench.folder.write("gone.obj", soft_box_obj(3, 3, 3));
    CHECK(bench.tray(parts).exit_code == 0);
    CHECK(read_json(bench.folder / "out/tray.json")["parts"].size() == 2);
}

TEST_CASE("A print that will not look as asked is no success of a strict tray") {
    const Bench bench("strict");
    const std::string words = "slice " + (bench.folder / "ramp.obj") + " " + (bench.folder / "ramp.obj") +
                              " --size 2mm --iterations 0 --verdict-good 1e-6 --verdict-bad 1e-5 -o " +
                              (bench.folder / "out");
    const Outcome quiet = run_program(words + " --strict --quiet");
    CHECK(quiet.exit_code == 6);
    CHECK_THAT(quiet.out, Catch::Matchers::StartsWith("ramp-1: On the whole bad") && !Contains("peak memory"));
    CHECK(run_program(words).exit_code == 0);  // as it was made
    CHECK(run_program(words + " --strict").exit_code == 6);
}

TEST_CASE("What is odd about places is said, what cannot be is refused") {
    const Bench bench("places");
    // A third of a millimetre is no whole number of voxels; of two looks one has what both fill.
    const Outcome odd = bench.tray(
        R"({"model": "ramp.obj", "at": [0.33, 0.33]}, {"model": "ramp.obj", "depth": "0.8mm", "at": [1, 1], "name": "b"})");
    CHECK(odd.exit_code == 0);
    CHECK_THAT(odd.err, Contains("ramp: lies up to") && Contains("whole voxels") && Contains("of the same priority") &&
                            Contains("[parts-overlap]"));
    CHECK(read_json(bench.folder / "out/tray.json")["parts"][0]["overlapped_by_equals_mm3"].get<double>() ==
          Approx(1.83 * 0.83 * 1.5).epsilon(0.1));
    const Outcome off = bench.tray(R"({"model": "marker.obj", "at": [489, 0]})", "--overwrite");
    CHECK(off.exit_code == 3);
    CHECK_THAT(off.err, Contains("parts[0]") && Contains("along x"));
}

TEST_CASE("A tray makes nothing in a strange folder") {
    const Bench bench("strange");
    fs::create_directory(bench.folder / "out");
    bench.folder.write("out/letter.txt", "dear");
    const Outcome refused = bench.tray(R"({"model": "marker.obj"})");
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("letter.txt"));
    const Outcome several = run_program("slice " + (bench.folder / "marker.obj") + " " + (bench.folder / "ramp.obj") +
                                        bare + "-o " + (bench.folder / "out"));
    CHECK(several.exit_code == 3);
    CHECK(read_tree(bench.folder / "out").size() == 1);
    for (const char* const shard : {"", "--shard 1/2 "}) {
        const Outcome nowhere = run_program("slice " + (bench.folder / "marker.obj") + " --copies 2" + bare + shard);
        CHECK(nowhere.exit_code == 2);
        CHECK_THAT(nowhere.err, Contains("name the folder"));
    }
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

TEST_CASE("An estimate of several models is that of their tray, and writes nothing") {
    const Bench bench("estimate");
    const std::string marker = bench.folder / "marker.obj", ramp = bench.folder / "ramp.obj";
    bench.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [{"model": "marker.obj"},
        {"model": "ramp.obj"}]})");
    const std::string words = "estimate --json --gap 3mm " + quick;
    const Outcome models = run_program(words + marker + " " + ramp + " -o " + (bench.folder / "out"));
    CAPTURE(models.err);
    REQUIRE(models.exit_code == 0);
    const json several = result_in(models), plan = result_in(run_program(words + (bench.folder / "tray.json")));
    CHECK(voxtone::io::schema_faults("estimate", several.dump()) == std::vector<std::string>{});
    for (const char* key : {"size_px", "layers", "ml", "disk_bytes", "resins"}) {
        CAPTURE(key);
        CHECK(several.at(key) == plan.at(key));
    }
    CHECK(several["model"] == marker + ", " + ramp);
    CHECK_FALSE(fs::exists(bench.folder / "out"));
    // What the print would refuse.
    const Outcome gone = run_program(words + marker + " " + (bench.folder / "gone.obj"));
    CHECK(gone.exit_code == 4);
    CHECK_THAT(gone.out, Contains("[part-failed]") && Contains("gone.obj"));
    const double left_ml = result_in(gone)["ml"];  // of the other part
    CHECK((left_ml > 0 && left_ml < several["ml"].get<double>()));
    for (const std::string& no : {"--orientations " + ramp, "--layers 0-5 " + ramp, bench.folder / "tray.json"})
        CHECK(run_program(words + marker + " " + no).exit_code == 2);
}

TEST_CASE("What finds no room on the plate goes over it, or onto the next tray, or is named") {
    const Bench bench("room");
    // Two times two that lie 2 mm apart.
    json printer = read_json(source_dir() + "/data/printers/stratasys-j750-hm.json");
    printer["tray_mm"] = {8, 6, 20};
    bench.folder.write("small.json", printer.dump());
    const std::string on_small = "--printer " + (bench.folder / "small.json") + " ";
    const std::string parts = R"({"model": "ramp.obj", "copies": 5})";
    const Outcome full = bench.tray(parts, on_small);
    CHECK(full.exit_code == 3);
    CHECK_THAT(full.err, Contains("1 of ramp") && Contains("--trays") && Contains("--arrange stacked"));
    CHECK_FALSE(fs::exists(bench.folder / "out/manifest.json"));
    const Outcome stacked = run_program("estimate --quick --json " + on_small + "--arrange stacked " +
                                        (bench.folder / "tray.json") + quick);
    REQUIRE(stacked.exit_code == 0);
    const double mm = result_in(stacked)["size_mm"][2];
    CHECK(mm >= 1.5 + 2 + 1.5);
    CHECK(mm < 1.5 + 2 + 1.5 + 2 * 32 * 0.027);

    REQUIRE(bench.tray(parts, on_small + "--trays 2").exit_code == 0);
    const json first = read_json(bench.folder / "out/tray.json"), second = read_json(bench.folder / "out-2/tray.json");
    CHECK(first["parts"][0]["at_px"].size() == 4);
    CHECK(second["parts"][0]["at_px"].size() == 1);
    CHECK(second["tray"] == 2);
    CHECK(run_program("verify --quiet " + on_small + (bench.folder / "out-2")).exit_code == 0);
}

TEST_CASE("Files of an assembly stand where their coordinates put them") {
    const Bench bench("assembly");
    const std::array<int, 3> low{70, 12, 15};
    bench.folder.write("first.obj", voxel_box_obj({0, 0, 0}, {60, 18, 40}, 1));
    bench.folder.write("second.obj", voxel_box_obj(low, {90, 30, 60}, 1));
    const std::string words = "slice --arrange none " + (bench.folder / "second.obj") + " " +
                              (bench.folder / "first.obj") + bare + "-o " + (bench.folder / "out");
    const Outcome assembled = run_program(words);
    CAPTURE(assembled.err);
    REQUIRE(assembled.exit_code == 0);
    CHECK(layers_in(bench.folder / "out").size() == 60);
    const json tray = read_json(bench.folder / "out/tray.json");
    CHECK(tray["parts"][0]["at_px"] == json{low});
    CHECK(tray["parts"][1]["at_px"] == json{{0, 0, 0}});
    const Outcome scaled = run_program(words + " --overwrite --size 4mm");
    CHECK(scaled.exit_code == 3);
    CHECK_THAT(scaled.err, Contains("second") && Contains("\"scale\"") && Contains("--arrange plate"));
}

TEST_CASE("A part is turned where it lies closer so") {
    const Bench bench("turned");
    bench.folder.write("bar.obj", soft_box_obj(6, 1.5, 1));
    // Along x a printer takes more passes.
    const Outcome turned =
        run_program("tray --turn " + (bench.folder / "bar.obj") + bare + " -o " + (bench.folder / "out"));
    CAPTURE(turned.err);
    REQUIRE(turned.exit_code == 0);
    CHECK_THAT(turned.err, Contains("bar: is turned by"));
    const std::string rotate = read_json(bench.folder / "out/tray.json")["parts"][0]["rotate"];
    CHECK((rotate == "z90" || rotate == "z270"));
}

TEST_CASE("Shards of a tray that loops, merged, are the tray") {
    const Bench bench("shards");
    bench.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "marker.obj", "copies": 2}, {"model": "ramp.obj", "size": "2mm", "at": [10, 2, 1]}]})");
    const std::string told = "slice --predict none " + (bench.folder / "tray.json") + " --size 2mm --iterations 1 -o ",
                      words = "slice --quiet" + told.substr(std::string("slice").size());
    const std::string whole = bench.folder / "whole", cut = bench.folder / "cut";
    REQUIRE(run_program(words + whole).exit_code == 0);
    constexpr int shards = 2;
    const Outcome too_soon = run_program(words + cut + " --shard 1/2");
    CHECK(too_soon.exit_code == 3);
    CHECK_THAT(too_soon.err, Contains("--until loop"));
    REQUIRE(run_program(words + cut + " --until loop").exit_code == 0);
    CHECK_FALSE(fs::exists(bench.folder / "cut/manifest.json"));
    for (int i = shards; i >= 1; --i) {
        const Outcome made = run_program(words + cut + fmt::format(" --shard {}/{}", i, shards));
        CAPTURE(made.err);
        REQUIRE(made.exit_code == 0);
    }
    CHECK_THAT(run_program(told + cut + fmt::format(" --shard 1/{}", shards)).out, Contains("made already"));
    const Outcome merged = run_program("merge --quiet " + cut);
    CAPTURE(merged.err);
    REQUIRE(merged.exit_code == 0);
    CHECK(layers_in(whole) == layers_in(cut));
    // Shards know no verdicts: what they are merged to names the parts without.
    json manifest = read_json(whole + "/manifest.json"), of_shards = read_json(cut + "/manifest.json");
    REQUIRE(manifest["members"].size() == 2);
    for (json& member : manifest["members"]) member.erase("verdict");
    manifest.erase("manifest_sha256"), of_shards.erase("manifest_sha256");
    CHECK(manifest == of_shards);
    const json a = read_json(whole + "/tray.json"), b = read_json(cut + "/tray.json");
    REQUIRE(b["parts"].size() == 2);
    for (std::size_t p = 0; p < 2; ++p) CHECK(a["parts"][p]["at_px"] == b["parts"][p]["at_px"]);
    // Merged is done.
    CHECK_THAT(run_program(told + cut).out, Contains("nothing was done"));
    CHECK_THAT(run_program("merge " + cut).out, Contains("merged already"));
    CHECK(run_program(words + cut + " --trays 2 --shard 1/2").exit_code == 2);
}

TEST_CASE("A tray is estimated: what its parts take, and resin and disk for every copy") {
    const Bench bench("estimate");
    const auto estimate = [&](const std::string& parts) {
        bench.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [)" + parts + "]}");
        const Outcome said = run_program("estimate --json " + (bench.folder / "tray.json") + quick);
        REQUIRE(said.exit_code == 0);
        return result_in(said);
    };
    const json one = estimate(R"({"model": "marker.obj", "rotate": "x45"})"),
               many = estimate(R"({"model": "marker.obj", "rotate": "x45", "copies": 5})");
    CHECK(many["ml"].get<double>() == Approx(5 * one["ml"].get<double>()));
    CHECK(many["layers"] == one["layers"]);
    CHECK(many["size_mm"][0].get<double>() * many["size_mm"][1].get<double>() >
          4 * one["size_mm"][0].get<double>() * one["size_mm"][1].get<double>());
    CHECK(many["cpu_seconds"].get<double>() < 3 * one["cpu_seconds"].get<double>());
    // The print is as the estimate says.
    REQUIRE(run_program("slice " + (bench.folder / "tray.json") + quick + "-o " + (bench.folder / "out")).exit_code ==
            0);
    const json manifest = read_json(bench.folder / "out/manifest.json");
    CHECK(manifest["layers"] == many["layers"]);
    CHECK(manifest["size_px"][0] == many["size_px"][0]);
    double ml = 0;
    for (const json& resin : manifest["resins"]) ml += resin["ml"].get<double>();
    CHECK(ml == Approx(many["ml"].get<double>()).epsilon(0.02));
    CHECK(read_json(bench.folder / "out/report.json").at("support_ml").get<double>() ==
          Approx(many.at("support_ml").get<double>()));
    CHECK(many.at("support_ml") > 0);
    CHECK(run_program("estimate --orientations " + (bench.folder / "tray.json")).exit_code == 2);
}

TEST_CASE("A tray is a job of a batch like any other") {
    const Bench bench("batch");
    bench.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "marker.obj", "copies": 2}, {"model": "ramp.obj"}]})");
    bench.folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "iterations": 0, "report": false})");
    bench.folder.write("plan.jsonl", "{\"model\": \"ramp.obj\"}\n{\"model\": \"tray.json\", \"name\": \"both\"}\n");
    const std::string words = "batch " + (bench.folder / "plan.jsonl") + " --preset " + (bench.folder / "quick.json") +
                              " -o " + (bench.folder / "jobs");
    const Outcome done = run_program(words);
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    REQUIRE(run_program("slice " + (bench.folder / "tray.json") + bare + "-o " + (bench.folder / "alone")).exit_code ==
            0);
    CHECK(layers_in(bench.folder / "jobs/both") == layers_in(bench.folder / "alone"));
    CHECK_THAT(run_program(words).out, Contains("2 before, and unchanged"));
    // A model of the tray that changes makes the tray anew, and that alone.
    bench.folder.write("marker.obj", soft_box_obj(2, 2, 2));
    CHECK_THAT(run_program(words).out, Contains("1 before, and unchanged"));
    CHECK(layers_in(bench.folder / "jobs/both") != layers_in(bench.folder / "alone"));
    // What is wrong with a part is known before a job starts.
    bench.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [{"model": "gone.obj"}]})");
    const Outcome wrong = run_program(words);
    CHECK(wrong.exit_code == 3);
    CHECK_THAT(wrong.err, Contains("gone.obj") && Contains("no job was started"));
}

TEST_CASE("A tray that is killed at random moments goes on to the same bits") {
    const Bench bench("killed");
    bench.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "marker.obj", "copies": 2}, {"model": "ramp.obj"}]})");
    const std::string words =
        "slice --quiet --size 2mm --iterations 2 --predict none " + (bench.folder / "tray.json") + " -o ";
    const auto began = std::chrono::steady_clock::now();
    REQUIRE(run_program(words + (bench.folder / "whole")).exit_code == 0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::mt19937 random(36);
    std::uniform_real_distribution<double> moment(0.05, 0.8);
    int killed = 0;
    for (int attempt = 0; attempt < 6; ++attempt) {
        const int code = run_shell(fmt::format("timeout -s KILL {:.2f} {} {}{} >{} 2>&1", moment(random) * seconds,
                                               program(), words, bench.folder / "out", bench.folder / "said"));
        CAPTURE(read_file(bench.folder.path() / "said"));
        killed += code != 0;
        if (code == 0) break;
        REQUIRE(code == 137);
    }
    CHECK(killed > 0);
    REQUIRE(run_program(words + (bench.folder / "out")).exit_code == 0);
    CHECK(layers_in(bench.folder / "out") == layers_in(bench.folder / "whole"));
}
