// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "run_program.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/print/run_print.h"
#include "tests/counted_parts.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;

namespace {

const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png";

nlohmann::json json_of(const std::string& file) { return nlohmann::json::parse(read_file(file)); }

/// Asks the work to stop after so many predictions of the loop.
class StopsAfter final : public Progress {
public:
    explicit StopsAfter(int predictions) : predictions_(predictions) {}

private:
    void on_stage(std::string_view name, std::uint64_t, std::string_view) override {
        in_loop_ = name == "appearance loop";
    }
    void on_advance(std::uint64_t done) override {
        if (in_loop_ && static_cast<int>(done) == predictions_) cancel();
    }
    int predictions_;
    bool in_loop_ = false;
};

class RecordsStages final : public Progress {
public:
    std::vector<std::string> begun;

private:
    void on_stage(std::string_view name, std::uint64_t, std::string_view) override { begun.emplace_back(name); }
};

slicer::SliceOptions small_slab(const Folder& folder, const std::string& out) {
    slicer::SliceOptions options;
    options.model = picture;
    options.out = folder / out;
    options.width_mm = 2.4;
    options.thickness_mm = 1;
    options.iterations.assign(1, '5');  // a literal here trips a warning of GCC 12
    options.report = false;
    return options;
}

}  // namespace

TEST_CASE(
    "The loop lowers the error, reports it and leaves a stack that verifies, the same for any number of threads") {
    const Folder folder("loop");
    std::string digest;
    for (const int threads : {1, 5}) {
        const std::string out = folder / fmt::format("out{}", threads);
        REQUIRE(
            run_program(fmt::format("slice --quiet --iterations 4 --threads {} {} --width 4mm --thickness 1mm -o {}",
                                    threads, picture, out))
                .exit_code == 0);
        CHECK(run_program("verify --quiet " + out).exit_code == 0);
        const nlohmann::json report = json_of(out + "/report.json"), loop = report.at("loop");
        REQUIRE(loop.at("iterations").size() == 5);
        const int best = loop.at("best");
        REQUIRE(best > 0);
        CHECK(loop["iterations"][std::size_t(best)]["seen_de2000"]["mean"].get<double>() <
              0.97 * loop["iterations"][0]["seen_de2000"]["mean"].get<double>());
        CHECK(std::filesystem::exists(out + "/open-loop.png"));
        CHECK_FALSE(std::filesystem::exists(out + "/loop.checkpoint"));
        const std::string content = json_of(out + "/manifest.json").at("content_sha256");
        if (digest.empty()) digest = content;
        CHECK(content == digest);
    }
}

TEST_CASE("Without iterations the open loop is printed, and nothing is said of a loop") {
    const Folder folder("no-loop");
    REQUIRE(run_program(fmt::format("slice --quiet --iterations 0 {} --width 2.4mm --thickness 1mm -o {}", picture,
                                    folder / "out"))
                .exit_code == 0);
    CHECK_FALSE(json_of(folder / "out/report.json").contains("loop"));
    CHECK(run_program(fmt::format("slice --iterations -1 {} --width 2mm -o {}", picture, folder / "other")).exit_code ==
          2);
    CHECK(run_program(fmt::format("slice --iterations often {} --width 2mm -o {}", picture, folder / "other"))
              .exit_code == 2);
}

TEST_CASE("A loop that was stopped and resumed makes the same print, bit by bit") {
    const Folder folder("resume");
    Progress quiet;
    const auto layers = [&](const std::string& out) {
        return read_tree(std::filesystem::path(folder / out) / "layers");
    };
    const auto errors = [&](const std::string& out) {
        std::vector<double> means;
        const auto report = json_of((folder / out) + "/report.json");
        for (const auto& step : report.at("loop").at("iterations")) means.push_back(step.at("seen_de2000").at("mean"));
        return means;
    };
    const auto run = [&](slicer::SliceOptions options, const std::string& method, Progress& progress) {
        options.loop_method = method;
        (void)slicer::run_print({options}, progress);
    };
    for (const std::string method : {"descent", "feedback"}) {
        const std::string whole = "whole-" + method;
        run(small_slab(folder, whole), method, quiet);
        // After the open loop, before descent takes over, in the middle of either.
        for (const int predictions : method == "descent" ? std::vector{1, 2, 3, 5} : std::vector{1, 3}) {
            CAPTURE(method, predictions);
            const std::string out = fmt::format("{}-{}", method, predictions);
            StopsAfter stops(predictions);
            CHECK_THROWS_AS(run(small_slab(folder, out), method, stops), Cancelled);
            REQUIRE(std::filesystem::exists(folder / out + "/loop.checkpoint"));
            slicer::SliceOptions resumed = small_slab(folder, out);
            resumed.resume = predictions > 2;  // the same command goes on, whether it says so or not
            run(resumed, method, quiet);
            CHECK(errors(out) == errors(whole));
            CHECK(layers(out) == layers(whole));
            CHECK_FALSE(std::filesystem::exists(folder / out + "/loop.checkpoint"));
        }
    }
}

TEST_CASE("An interrupted loop is not thrown away, not taken for another job's, and printed when that is asked for") {
    const Folder folder("stopped");
    Progress quiet;
    StopsAfter stops(3);
    CHECK_THROWS_AS(slicer::run_print({small_slab(folder, "out")}, stops), Cancelled);
    slicer::SliceOptions other = small_slab(folder, "out");
    other.iterations.assign(1, '0');
    CHECK_THROWS_WITH(slicer::run_print({other}, quiet), Catch::Contains("--resume"));
    other = small_slab(folder, "out");
    other.depth_mm = 0.5;
    CHECK_THROWS_WITH(slicer::run_print({other}, quiet), Catch::Contains("--overwrite"));
    other = small_slab(folder, "out");
    other.resume = true;
    other.depth_mm = 0.5;
    // Refused before the model is read.
    RecordsStages stages;
    CHECK_THROWS_WITH(slicer::run_print({other}, stages), Catch::Contains("belongs to a job with other options"));
    CHECK(stages.begun.empty());
    // A resin set of the same name that says something else.
    std::string resins = read_file(source_dir() + "/data/resins/j750-vivid.json");
    folder.write("mine.json", resins);
    other = small_slab(folder, "out");
    other.resume = true;
    other.resins = folder / "mine.json";
    other.iterations.assign(1, '0');
    other.threads = 1;
    const std::size_t at = resins.find("\"g\": 0.4");
    REQUIRE(at != std::string::npos);
    resins[at + 7] = '3';
    folder.write("mine.json", resins);
    CHECK_THROWS_AS(slicer::run_print({other}, quiet), InputError);
    // The set of the program in a file of another name is the same job; no more iterations are made.
    folder.write("mine.json", read_file(source_dir() + "/data/resins/j750-vivid.json"));
    const std::size_t saved = slicer::LoopCheckpoint::saved_steps(folder / "out");
    REQUIRE(saved >= 1);  // of three that were made the last are lost where a state took too long to write
    (void)slicer::run_print({other}, quiet);
    CHECK(run_program("verify --quiet " + (folder / "out")).exit_code == 0);
    CHECK(json_of(folder / "out/report.json").at("loop").at("iterations").size() == saved);
    CHECK_FALSE(std::filesystem::exists(folder / "out/loop.checkpoint"));
}

TEST_CASE("A state that cannot be saved is warned about once, and the job goes on") {
    const Folder folder("unsaved");
    class Listens final : public Progress {
    public:
        std::vector<std::string> told;

    private:
        void on_warning(const std::string& message) override {
            if (message.find("loop.checkpoint") != std::string::npos) told.push_back(message);
        }
    } progress;
    // A folder in the place of the file.
    std::filesystem::create_directories(folder / "out/loop.checkpoint/there");
    slicer::SliceOptions options = small_slab(folder, "out");
    options.overwrite = true;
    options.iterations.assign(1, '2');
    (void)slicer::run_print({options}, progress);
    REQUIRE(progress.told.size() == 1);
    CHECK_THAT(progress.told[0], Catch::Contains("cannot be resumed") && Catch::Contains("[not-resumable]"));
    CHECK(run_program("verify --quiet " + (folder / "out")).exit_code == 0);
}

TEST_CASE("A scheduler's SIGTERM in the loop leaves with 85 and a state to go on from, Ctrl-C with 5") {
    const Folder folder("signalled");
    for (const auto& [signal, code] : {std::pair(SIGTERM, 85), std::pair(SIGINT, 5)}) {
        const std::string slice = fmt::format("slice --json --iterations 3 {} --width 2.4mm --thickness 1mm -o {}",
                                              picture, folder / fmt::format("out{}", code));
        const Outcome outcome = run_and_signal(slice, "iteration 1 ", signal);
        INFO(outcome.out << outcome.err);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Catch::Contains("the same command without --overwrite goes on"));
        const Outcome again = run_program(slice);
        CHECK(again.exit_code == 0);
        CHECK_THAT(again.out, Catch::Contains("going on after iteration"));
    }
}

TEST_CASE("Where there is nothing to rearrange the job says so and goes on") {
    const Folder folder("nothing");
    const auto loop_of = [&](const std::string& arguments) {
        const std::string out = folder / "out";
        const Outcome outcome = run_program(fmt::format("slice --overwrite --iterations 2 {} -o {}", arguments, out));
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        CHECK(run_program("verify --quiet " + out).exit_code == 0);
        return json_of(out + "/report.json").contains("loop");
    };
    const std::string slab = picture + " --width 2mm --thickness 1mm ";
    CHECK_FALSE(loop_of(slab + "--load W"));
    // Without white, without black: the core stands in for white.
    CHECK(loop_of(slab + "--load C,M,Y,K --core Y"));
    CHECK(loop_of(slab + "--load C,M,Y,W"));
    // A wall thinner than two voxels, of one colour.
    folder.write("wall.obj", ramp_box_obj(2, 0.1, 1.5));
    CHECK(loop_of((folder / "wall.obj") + " --resins vero-opaque"));
    folder.write("marker.obj", marker_obj());
    CHECK(loop_of((folder / "marker.obj") + " --size 2mm"));
}

TEST_CASE("Large bodies are rearranged without being asked, and what that takes is announced") {
    const Folder folder("large");
    // 64 cm2 take minutes: told first, and stopped as soon as it was.
    slicer::SliceOptions options;
    options.model = picture;
    options.out = folder / "usual";
    options.width_mm = 80;
    options.thickness_mm = 1;
    options.report = false;
    class StopsWhenTold final : public Progress {
    public:
        std::string told;

    private:
        void on_note(const std::string& note) override {
            told += note + "\n";
            if (note.find("the appearance loop takes about") != std::string::npos) cancel();
        }
    } progress;
    CHECK_THROWS_AS(slicer::run_print({options}, progress), Cancelled);
    INFO(progress.told);
    CHECK(progress.told.find(" min") != std::string::npos);
    CHECK(progress.told.find("GiB of memory") != std::string::npos);
    CHECK(progress.told.find("--iterations 0") != std::string::npos);

    // What is printed depends on the job alone: where the loop does not fit the job stops, and prints no other stack.
    const Outcome small = run_program("slice " + picture + " --width 60mm --thickness 1mm --memory 0.8 --layers 0-3 " +
                                      "--predict none --no-report -o " + folder / "small");
    INFO(small.err);
    CHECK(small.exit_code == 5);
    CHECK(small.err.find("the appearance loop on 36 cm2 of coloured surface takes 1.0") != std::string::npos);
    CHECK(small.err.find("GiB of memory at the least, and 819 MiB are allowed: allow more (--memory)") !=
          std::string::npos);
    CHECK_FALSE(std::filesystem::exists(std::filesystem::path(folder / "small") / "manifest.json"));
}

TEST_CASE("Each prediction of a loop tells how far it is") {
    const Folder folder("parts");
    for (const std::string method : {"descent", "feedback"}) {
        CountedParts parts;
        slicer::SliceOptions options = small_slab(folder, method);
        options.loop_method = method;
        options.iterations = "4";
        options.predict = "none";
        (void)slicer::run_print({options}, parts);
        std::size_t predictions = 0;
        for (const std::vector<double>& step : parts.told) {
            if (step.empty()) continue;
            ++predictions;
            CAPTURE(method, predictions, step);
            CHECK(step.size() >= 6);
            CHECK(std::ranges::is_sorted(step));
            CHECK(step.back() == Approx(1));
        }
        CHECK(predictions >= 5);
    }
}
