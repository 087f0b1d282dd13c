// SPDX-License-Identifier: GPL-3.0-or-later
//
// What whole runs, shards and merges ask of a plate, whatever it holds: in which order, and what they leave.
#include <algorithm>
#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "listed_plate.h"
#include "slicer/print/run_shard.h"
#include "slicer/print/run_whole.h"
#include "small_print.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;
using Calls = std::vector<std::string>;

struct ShardsDesk : PrintDesk {
    /// Without a page, into "out".
    [[nodiscard]] SliceOptions shard(const std::string& number) const {
        SliceOptions options = this->options("out");
        options.shard = number;
        options.report = false;
        return options;
    }
    JobResult make(ListedPlate& plate) { return run_shard(plate, said); }
    JobResult make(const SliceOptions& options) {
        ListedPlate plate(options);
        return make(plate);
    }
    void make_both(SliceOptions options) {
        for (const char* number : {"1/2", "2/2"}) {
            options.shard = number;
            (void)make(options);
        }
    }
    [[nodiscard]] io::ShardRecord record(std::uint32_t shard, std::uint32_t of) const {
        return io::read_shard(io::shard_file(path("out"), {shard, of}));
    }
    /// Says whether it is told already, and counts how often it was.
    JobResult merge(const MergeOptions& options, bool is_told = false) {
        return run_merge_job(options,
                             {[is_told](const io::ShardSet&) { return is_told; },
                              [this](const io::ShardSet& shards) {
                                  ++told;
                                  return JobResult{"{}", fmt::format("told of {}", shards.records.size())};
                              }},
                             said);
    }
    [[nodiscard]] MergeOptions merging() const {
        MergeOptions options;
        options.out = path("out");
        return options;
    }
    int told = 0;
};

}  // namespace

TEST_CASE("A whole print asks its plate in one order, and ends where the plate does") {
    PrintDesk desk;
    SliceOptions options = desk.options("out");
    options.threads = 1;
    const Calls all{"take", "done", "replaceable", "prepare", "rearrange", "print"};
    ListedPlate whole(options);
    CHECK(run_whole(whole, desk.said).text == "printed");
    CHECK(whole.calls == all);
    CHECK(whole.is_own_folder);
    CHECK(whole.threads == 1);
    for (const std::size_t n : {1u, 4u}) {
        ListedPlate plate(options);
        plate.ends_at = all[n];
        CHECK(run_whole(plate, desk.said).text == "ended at " + all[n]);
        CHECK(plate.calls == Calls(all.begin(), all.begin() + std::ptrdiff_t(n) + 1));
    }
    ListedPlate refused(options);
    refused.throws_at = "replaceable";
    CHECK_THROWS_WITH(run_whole(refused, desk.said), "refused at replaceable");
    CHECK(refused.calls.size() == 3);
}

TEST_CASE("A shard is refused before its plate is read, and is made of as many layers as its work comes to") {
    ShardsDesk desk;
    SliceOptions options = desk.shard("1/2");
    options.threads = 1;
    {
        ListedPlate refused(options);
        refused.throws_at = "loops";
        CHECK_THROWS_AS(desk.make(refused), InputError);
        CHECK(refused.calls == Calls{"loops"});
        CHECK_FALSE(fs::exists(desk.path("out/shards")));
        SliceOptions of_volume = options;
        of_volume.formats = {"vdb"};
        ListedPlate vdb(of_volume);
        CHECK_THROWS_AS(desk.make(vdb), UsageError);
        CHECK(vdb.calls.empty());
    }
    ListedPlate plate(options);
    const fs::path job_file = desk.path("out/shards/job.json");
    std::map<std::string, bool> claimed;
    plate.at = [&](const std::string& call) { claimed[call] = fs::exists(job_file); };
    const JobResult made = desk.make(plate);
    // The folder is the job's before its layers are made, and after the last refusal.
    CHECK(plate.calls == Calls{"loops", "prepare", "disk", "keep", "make"});
    CHECK((!claimed.at("disk") && claimed.at("keep") && claimed.at("make")));
    CHECK(plate.threads == 1);
    CHECK_FALSE(plate.same_job_before);
    CHECK((plate.made.first == 5 && plate.made.last == 39));
    CHECK((plate.disk.first == 5 && plate.disk.last == 39));
    const json says = json::parse(made.json);
    CHECK(says.at("format") == "voxtone-shard-done");
    CHECK((says.at("shard") == 1 && says.at("of") == 2 && says.at("first_layer") == 5 && says.at("layers") == 35));
    CHECK(says.at("record") == desk.path("out/shards/0001-of-0002.json").string());
    CHECK(made.exit_code == ExitCode::done);
    CHECK_THAT(made.text, Contains("layers 5 to 39, done in"));
    const io::ShardRecord record = desk.record(1, 2);
    CHECK((record.first_layer == 5 && record.layers == 35));
    CHECK((record.stack.first_layer == 5 && record.stack.layers == 45));
    CHECK(record.job == plate.identity());
    CHECK(record.first_task == 1);
    CHECK((record.png && !record.gcvf));
    CHECK(record.written.file_bytes.size() == 35);
    CHECK(record.figures.body_voxels == 35 * 4);
    CHECK((record.figures.shell_s == 35 && record.figures.encode_s == 70 && record.figures.layers_s == 17.5));
    CHECK(record.figures.peak_memory_bytes > 0);
    CHECK((record.figures.total_s > 0 && record.figures.total_s < 60));
    CHECK((record.pictures.empty() && !record.host.empty()));

    ListedPlate second(desk.shard("2/2"));
    CHECK_THAT(desk.make(second).text, Contains("layers 40 to 49, done in"));
    CHECK(second.same_job_before);
    CHECK((second.made.first == 40 && second.made.last == 49));
}

TEST_CASE("A shard that is there whole is not made again, unless that is asked for or a file of it is gone") {
    ShardsDesk desk;
    (void)desk.make(desk.shard("1/2"));
    ListedPlate again(desk.shard("1/2"));
    const JobResult result = desk.make(again);
    CHECK(again.calls.empty());
    CHECK_THAT(result.text, Contains("layers 5 to 39; made already, nothing was done"));
    CHECK(json::parse(result.json).at("layers") == 35);
    SliceOptions overwriting = desk.shard("1/2");
    overwriting.overwrite = true;
    ListedPlate anew(overwriting);
    (void)desk.make(anew);
    CHECK(anew.calls.back() == "make");

    const fs::path store = desk.path("out/shards") / io::shard_store(anew.identity());
    const fs::directory_iterator layers(store / "layers");
    REQUIRE(layers != fs::directory_iterator());
    fs::remove(layers->path());
    ListedPlate mended(desk.shard("1/2"));
    CHECK_THAT(desk.make(mended).text, Contains("done in"));
    CHECK(mended.same_job_before);
    // Of more shards than slabs some have no layers.
    SliceOptions many = desk.shard("5/9");
    many.out = desk.path("many").string();
    const JobResult none = desk.make(many);
    CHECK_THAT(none.text, Contains("no layers: there are more shards than slabs"));
    CHECK(json::parse(none.json).at("layers") == 0);
    // What is no record is no shard.
    std::ofstream(io::shard_file(desk.path("many"), {5, 9})) << "{}";
    CHECK_THAT(desk.make(many).text, Contains("done in"));
}

TEST_CASE("Tasks of a second array are the shards that the first one's numbers say, and what is no number is refused") {
    ShardsDesk desk;
    const auto task = [&](const std::string& id, int first, int last, int count) {
        const std::map<std::string, std::string> all{{"ID", id},
                                                     {"MIN", std::to_string(first)},
                                                     {"MAX", std::to_string(last)},
                                                     {"COUNT", std::to_string(count)}};
        for (const auto& [name, value] : all) setenv(("SLURM_ARRAY_TASK_" + name).c_str(), value.c_str(), 1);
        std::string said;
        try {
            said = desk.make(desk.shard("auto")).json;
        } catch (const UsageError& error) {
            said = error.what();
        }
        for (const auto& [name, value] : all) unsetenv(("SLURM_ARRAY_TASK_" + name).c_str());
        return said;
    };
    CHECK_THAT(task("three", 0, 4, 5), Contains("SLURM_ARRAY_TASK_ID is 'three', which is no number"));
    CHECK_THAT(task("3x", 0, 4, 5), Contains("'3x'"));
    CHECK_THAT(task("3", 0, 4, 0), Contains("--shard 3/16"));
    // The first array, of tasks 0 to 4, made the second shard; then 0, 2 and 4 are sent again.
    CHECK(json::parse(task("1", 0, 4, 5)).at("shard") == 2);
    CHECK(desk.record(2, 5).first_task == 0);
    for (const int id : {0, 2, 4}) {
        const json made = json::parse(task(std::to_string(id), 0, 4, 3));
        CHECK((made.at("shard") == id + 1 && made.at("of") == 5));
    }
    CHECK_THAT(task("5", 0, 5, 3), Contains("cannot be numbered"));
    // A record that cannot be read says nothing, and the others still do.
    std::ofstream(io::shard_file(desk.path("out"), {1, 5})) << "{}";
    CHECK(json::parse(task("4", 4, 4, 1)).at("of") == 5);
}

TEST_CASE("Shards of another job are lost only where that is asked for") {
    ShardsDesk desk;
    desk.make_both(desk.shard(""));
    SliceOptions other = desk.shard("1/2");
    other.depth_mm = 0.5;
    {
        ListedPlate plate(other);
        CHECK_THROWS_WITH(desk.make(plate), Contains("shards of another job"));
        CHECK(plate.calls.empty());
    }
    other.overwrite = true;
    ListedPlate plate(other);
    (void)desk.make(plate);
    CHECK_FALSE(plate.same_job_before);
    CHECK(desk.record(1, 2).job == plate.identity());
    CHECK_FALSE(fs::exists(desk.path("out/shards/0002-of-0002.json")));
    // The same job's others stay.
    other.shard = "2/2";
    (void)desk.make(other);
    CHECK(fs::exists(desk.path("out/shards/0001-of-0002.json")));
}

TEST_CASE("Shards are merged once, and told of where a report is wanted and was not written") {
    ShardsDesk desk;
    desk.make_both(desk.shard(""));
    const fs::path kept = io::prepared_file(desk.path("out"), desk.record(1, 2).job);
    REQUIRE(fs::exists(kept));
    MergeOptions options = desk.merging();
    CHECK(desk.merge(options).text == "told of 2");
    CHECK(fs::exists(desk.path("out/manifest.json")));
    CHECK(fs::exists(desk.path("out/printer/HOW-TO-PRINT.html")));
    CHECK(fs::exists(desk.path("out/job.json")));
    CHECK(fs::exists(kept));  // whoever tells of it reads it
    CHECK(desk.merge(options).text == "told of 2");
    CHECK(desk.told == 2);
    const JobResult done = desk.merge(options, true);
    CHECK_THAT(done.text, Contains("45 layers of 2 shards; merged already, with its report; nothing was done"));
    options.predict = true;
    (void)desk.merge(options, true);
    CHECK(desk.told == 3);
    options.report = false;
    const JobResult merged = desk.merge(options);
    CHECK(desk.told == 3);
    CHECK_THAT(merged.text, Contains("45 layers of 2 shards; merged already\n"));
    CHECK_FALSE(fs::exists(kept));
    const json says = json::parse(merged.json);
    CHECK(says.at("format") == "voxtone-merge");
    CHECK(says.at("stack") == desk.path("out").string());
    CHECK((says.at("shards") == 2 && says.at("layers") == 45));
    CHECK(says.at("content_sha256") == desk.content("out"));
    // None of its shards is made any more.
    ListedPlate after(desk.shard("1/2"));
    const JobResult nothing = desk.make(after);
    CHECK(after.calls.empty());
    CHECK_THAT(nothing.text, Contains("holds this job's stack already, whole"));
    CHECK(json::parse(nothing.json).at("merged") == desk.path("out").string());
    SliceOptions overwriting = desk.shard("1/2");
    overwriting.overwrite = true;
    CHECK_THAT(desk.make(overwriting).text, Contains("done in"));
}

TEST_CASE("A merge replaces another job's stack where it may, and what refuses it leaves all as it was") {
    ShardsDesk desk;
    desk.make_both(desk.shard(""));
    MergeOptions options = desk.merging();
    options.report = false;
    const std::string job = io::text_of(desk.path("out/shards/job.json"));
    {
        json of_another = json::parse(job);
        of_another.at("depth") = "0.5mm";
        std::ofstream(desk.path("out/shards/job.json")) << of_another;
        CHECK_THROWS_WITH(desk.merge(options), Contains("is not of the job that the shards are of"));
        std::ofstream(desk.path("out/shards/job.json")) << job;
    }
    fs::create_directories(desk.path("usb/other"));
    options.for_printer = desk.path("usb");
    CHECK_THROWS_AS(desk.merge(options), InputError);
    CHECK_FALSE(fs::exists(desk.path("out/manifest.json")));
    options.for_printer = desk.path("stick");
    CHECK_THAT(desk.merge(options).text, Contains("45 layers of 2 shards; merged\n"));
    CHECK(fs::exists(desk.path("stick/HOW-TO-PRINT.html")));
    const std::string before = desk.content("out");

    SliceOptions other = desk.shard("");
    other.depth_mm = 0.5;
    other.overwrite = true;
    desk.make_both(other);
    const std::string manifest = io::text_of(desk.path("out/manifest.json"));
    options.for_printer.clear();
    CHECK_THROWS_WITH(desk.merge(options), Contains("--overwrite"));
    CHECK(io::text_of(desk.path("out/manifest.json")) == manifest);
    options.overwrite = true;
    CHECK_THAT(desk.merge(options).text, Contains("shards; merged\n"));
    CHECK(json::parse(io::text_of(desk.path("out/job.json"))).at("depth") == "0.5mm");
    // Though its layers, of a plate that always has the same, are what lay there.
    CHECK(desk.content("out") == before);
}

TEST_CASE("Where the job cannot be opened when its shards are merged, the printer's folder is made up for later") {
    ShardsDesk desk;
    const fs::path profile = desk.path("own.json");
    const std::string text = io::text_of(fs::path(source_dir()) / "data/printers/stratasys-j750-hm.json");
    std::ofstream(profile) << text;
    SliceOptions options = desk.shard("");
    options.printer = profile.string();
    desk.make_both(options);
    fs::remove(profile);
    MergeOptions merging = desk.merging();
    merging.report = false;
    CHECK_THAT(desk.merge(merging).text, Contains("shards; merged\n"));
    CHECK_THAT(desk.said.warnings(), Contains("[printer-folder]") && Contains("own.json"));
    CHECK(fs::exists(desk.path("out/manifest.json")));
    CHECK_FALSE(fs::exists(desk.path("out/printer")));
    const fs::path kept = io::prepared_file(desk.path("out"), desk.record(1, 2).job);
    CHECK(fs::exists(kept));  // the page still asks for it
    std::ofstream(profile) << text;
    CHECK_THAT(desk.merge(merging).text, Contains("merged already"));
    CHECK_THAT(io::text_of(desk.path("out/printer/HOW-TO-PRINT.html")), Contains("box.obj"));
    CHECK_FALSE(fs::exists(kept));
}
