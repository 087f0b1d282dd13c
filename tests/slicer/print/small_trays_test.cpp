// SPDX-License-Identifier: GPL-3.0-or-later
//
// Trays on their ways: several of them, as far as the loops, in shards and merged.
#include <algorithm>
#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/shards/shard_folder.h"
#include "small_print.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;

struct PlansDesk : PrintDesk {
    PlansDesk() { write_box("small.obj", {1, 1.2, 1}); }

    /// A plan of these parts, without pages.
    [[nodiscard]] SliceOptions of(const std::string& parts, const std::string& out = "out") const {
        std::ofstream(path("tray.json")) << R"({"format": "voxtone-tray", "version": 1, "parts": [)" + parts + "]}";
        SliceOptions options = this->options(out);
        options.model = path("tray.json").string();
        options.report = false;
        return options;
    }
    /// A printer with a plate that takes two rows of three small boxes.
    [[nodiscard]] std::string small_printer() const {
        nlohmann::json printer =
            nlohmann::json::parse(io::text_of(fs::path(source_dir()) / "data/printers/stratasys-j750-hm.json"));
        printer["tray_mm"] = {7.5, 5, 20};
        std::ofstream(path("small-printer.json")) << printer;
        return path("small-printer.json").string();
    }
    /// Layers that the first of two shards makes, of all.
    [[nodiscard]] double lower_half(const std::string& parts, const std::string& out) {
        SliceOptions options = of(parts, out);
        options.shard = "1/2";
        (void)print(options);
        const io::ShardRecord record = io::read_shard(io::shard_file(path(out), {1, 2}));
        return double(record.layers) / record.stack.layers;
    }
    void shards(SliceOptions options) {
        for (const char* number : {"1/2", "2/2"}) {
            options.shard = number;
            (void)print(options);
        }
    }
    JobResult merge(bool predict = false) {
        MergeOptions options;
        options.out = path("out");
        options.predict = predict;
        return run_merge(options, said);
    }
    template <class Fault>
    void refused(const SliceOptions& options, const std::string& words) {
        try {
            (void)print(options);
            FAIL("not refused: " + words);
        } catch (const Fault& fault) {
            CHECK_THAT(fault.what(), Contains(words));
        }
    }
};

}  // namespace

TEST_CASE("What finds no room on a tray goes onto the next, each with a folder, a page and a file for the printer") {
    PlansDesk desk;
    SliceOptions options = desk.of(R"({"model": "small.obj", "copies": 7})");
    options.printer = desk.small_printer();
    options.trays = 2;
    options.for_printer = desk.path("usb.zip").string();
    // What lies in the second's place is asked for before anything is made.
    fs::create_directories(desk.path("out-2/layers"));
    std::ofstream(desk.path("out-2/manifest.json")) << "{}";
    desk.refused<InputError>(options, "out-2");
    CHECK_FALSE(fs::exists(desk.path("out/manifest.json")));
    fs::remove_all(desk.path("out-2"));
    std::ofstream(desk.path("usb-2.zip")) << "mine";
    desk.refused<InputError>(options, "usb-2.zip");
    CHECK_FALSE(fs::exists(desk.path("out/manifest.json")));
    fs::remove(desk.path("usb-2.zip"));

    const JobResult result = desk.print(options);
    const json first = desk.json("out/tray.json"), second = desk.json("out-2/tray.json");
    CHECK(json::parse(result.json) == first);
    CHECK_THAT(result.text, Contains(desk.path("out").string() + ": ") && Contains("6 copies") &&
                                Contains(desk.path("out-2").string() + ": ") && Contains("once"));
    CHECK((first.at("tray") == 1 && second.at("tray") == 2));
    CHECK((first.at("trays") == 2 && second.at("trays") == 2));
    CHECK((first["parts"][0]["at_px"].size() == 6 && second["parts"][0]["at_px"].size() == 1));
    CHECK(second.at("content_sha256") == desk.content("out-2"));
    CHECK(desk.content("out") != desk.content("out-2"));
    CHECK(desk.json("out-2/job.json").at("trays") == desk.json("out/job.json").at("trays"));
    CHECK_THAT(io::text_of(desk.path("out/printer/HOW-TO-PRINT.html")), Contains("a tray of 6 parts"));
    CHECK_THAT(io::text_of(desk.path("out-2/printer/HOW-TO-PRINT.html")), Contains("a tray of 1 part<"));
    for (const char* file : {"usb.zip", "usb-2.zip"}) CHECK(fs::exists(desk.path(file)));

    // The same again hands both over, and does nothing besides.
    options.for_printer = desk.path("stick").string();
    CHECK_THAT(desk.print(options).text, Contains("holds this tray already"));
    for (const char* folder : {"stick", "stick-2"})
        CHECK(fs::exists(desk.path(std::string(folder) + "/HOW-TO-PRINT.html")));
    CHECK_FALSE(fs::exists(desk.path("stick-3")));
    options.trays = 1;
    options.out = desk.path("full").string();
    options.for_printer.clear();
    desk.refused<InputError>(options, "1 of small");
}

TEST_CASE("A tray that goes as far as the loops keeps what they came to, and its shards ask for that") {
    PlansDesk desk;
    SliceOptions options = desk.of(R"({"model": "small.obj", "copies": 2}, {"box": [1, 1, 1.2], "resin": "W"})");
    options.iterations.assign(1, '1');
    options.predict_cell_mm = 0.3;
    options.shard = "1/2";
    desk.refused<Error>(options, "--until loop");
    options.shard.clear();
    options.until = "loop";
    const JobResult kept = desk.print(options);
    const json says = json::parse(kept.json);
    CHECK(says.at("format") == "voxtone-tray-loops");
    CHECK(says.at("parts") == json({"small"}));
    CHECK_THAT(kept.text, Contains("what the loops of 1 parts came to is kept"));
    CHECK(kept.exit_code == ExitCode::done);
    CHECK(fs::exists(desk.path("out/parts/small/skin.mixtures")));
    CHECK_FALSE(fs::exists(desk.path("out/manifest.json")));
    options.until = "end";
    desk.shards(options);
    CHECK_THAT(desk.merge().text, Contains("small"));
    CHECK(desk.json("out/manifest.json").at("members").size() == 2);

    options.shard = "1/2";
    options.trays = 2;
    desk.refused<UsageError>(options, "leave --trays out");
    options.trays = 1;
    options.formats = {"gcvf"};
    options.out = desk.path("other").string();
    options.iterations.assign(1, '0');
    desk.refused<UsageError>(options, "of a tray is not made in shards");
}

TEST_CASE("A tray is cut into shards by the work of its parts: of each once for every height it stands at") {
    PlansDesk desk;
    const std::string below = R"({"model": "small.obj", "at": [[5, 5, 0]]})";
    // Its voxels are known: each is a fiftieth of the work of a coloured one.
    CHECK(desk.lower_half(below + R"(, {"box": [1, 1.2, 1], "resin": "W", "at": [[5, 5, 3]]})", "light") < 0.3);
    CHECK(desk.lower_half(below + R"(, {"box": [30, 24, 1], "resin": "W", "at": [[0, 0, 3]]})", "heavy") > 0.7);
    const double twice = desk.lower_half(R"({"model": "small.obj", "copies": 2, "at": [[5, 5, 0], [5, 5, 3]]})", "two");
    CHECK((twice > 0.25 && twice < 0.76));  // between both
    const double beside =
        desk.lower_half(R"({"model": "small.obj", "copies": 3, "at": [[5, 5, 0], [9, 5, 0], [5, 5, 3]]})", "three");
    CHECK(beside == twice);
}

TEST_CASE("What lies in each other's way on a tray is said, of the whole print and of merged shards") {
    PlansDesk desk;
    const std::string parts = R"({"box": [2, 2, 1], "resin": "W", "at": [[0, 0, 0]], "name": "under"},
        {"box": [2, 2, 1], "resin": "K", "at": [[1, 0, 0]], "name": "over"})";
    SliceOptions whole = desk.of(parts, "whole");
    (void)desk.print(whole);
    const json wanted = desk.json("whole/tray.json");
    CHECK(wanted["parts"][0]["overlapped_mm3"].get<double>() == Approx(2).epsilon(0.1));
    CHECK(wanted["parts"][1]["overlapped_mm3"] == 0);
    const std::string warned = desk.said.warnings();
    CHECK_THAT(warned, Contains("under") && Contains("over"));
    PlansDesk cut;
    SliceOptions options = cut.of(parts);
    cut.shards(options);
    CHECK_THAT(cut.said.warnings(), !Contains("under"));
    const JobResult merged = cut.merge();
    CHECK_THAT(cut.said.warnings(), Contains("under"));
    CHECK(cut.json("out/tray.json").at("parts") == wanted.at("parts"));
    CHECK(json::parse(merged.json) == cut.json("out/tray.json"));
    CHECK_THAT(merged.text, Contains("once"));
    CHECK_THAT(cut.merge().text, Contains("merged already"));
    fs::remove(cut.path("out/tray.json"));
    CHECK(json::parse(cut.merge().json).at("parts") == wanted.at("parts"));
}

TEST_CASE("Of a merged tray whose model has changed nothing is told") {
    PlansDesk desk;
    const SliceOptions options = desk.of(R"({"model": "small.obj"}, {"box": [1, 1, 1.2], "resin": "W"})");
    desk.shards(options);
    desk.write_box("small.obj", {1, 1.2, 1.2});
    CHECK_THROWS_WITH(desk.merge(), Contains("nothing can be told of its parts") && Contains("--no-report"));
    CHECK(fs::exists(desk.path("out/manifest.json")));
    CHECK_FALSE(fs::exists(desk.path("out/tray.json")));
}

TEST_CASE("A merged tray is predicted and drawn where that is asked for") {
    PlansDesk desk;
    SliceOptions options = desk.of(R"({"model": "small.obj"}, {"box": [1, 1, 1.2], "resin": "W", "name": "spacer"})");
    options.report = true;
    options.predict = "transport";
    options.predict_cell_mm = 0.4;
    desk.shards(options);
    (void)desk.merge();
    CHECK_FALSE(fs::exists(desk.path("out/report.html")));
    CHECK_FALSE(desk.json("out/tray.json")["parts"][0].contains("verdict"));
    CHECK(desk.json("out/report.json").at("layers") == desk.json("out/tray.json").at("layers"));
    (void)desk.merge(true);
    CHECK(desk.json("out/tray.json")["parts"][0].contains("verdict"));
    CHECK_THAT(io::text_of(desk.path("out/report.html")), Contains("spacer") && Contains("voxel-data"));
    CHECK(fs::exists(desk.path("out/parts/small/report.html")));
}

TEST_CASE("A part that fails is named where the others are printed, and a shard is of all or of none") {
    PlansDesk desk;
    std::ofstream(desk.path("broken.obj")) << "v 0 0 0\nf 1 2 3\n";
    SliceOptions options = desk.of(R"({"model": "small.obj"}, {"model": "broken.obj"})");
    const JobResult result = desk.print(options);
    CHECK_THAT(result.text, Contains("broken") && Contains("fails: "));
    CHECK(result.exit_code == ExitCode::invalid_input);
    CHECK_THAT(io::text_of(desk.path("out/printer/HOW-TO-PRINT.html")), Contains("broken is not in this print"));
    options.out = desk.path("cut").string();
    options.shard = "1/2";
    desk.refused<Error>(options, "broken.obj");
    CHECK_FALSE(fs::exists(desk.path("cut/shards/job.json")));
    // A strange folder is refused before anything is made in it.
    fs::create_directories(desk.path("strange/layers"));
    SliceOptions models = desk.options("strange");
    models.model.clear();
    models.report = false;
    for (const char* shard : {"", "1/2"}) {
        models.shard = shard;
        CHECK_THROWS_AS(desk.tray(models, {"small.obj"}, 2), InputError);
        CHECK_FALSE(fs::exists(desk.path("strange/parts")));
    }
}
