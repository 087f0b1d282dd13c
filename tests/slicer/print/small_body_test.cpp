// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body's own part in its print: what it goes on from, what it keeps, warns of and leaves for its shards and their
// merge.
#include <algorithm>
#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/job_outlook.h"
#include "base/stop_deadline.h"
#include "io/disk/disk_space.h"
#include "io/shards/shard_folder.h"
#include "slicer/part/phase.h"
#include "slicer/predict/stack_volume.h"
#include "small_print.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;

struct BodyDesk : PrintDesk {
    BodyDesk() { write_box("small.obj", {1, 1.2, 1.1}); }

    /// Of the small box, without a page.
    [[nodiscard]] SliceOptions small(const std::string& out) const {
        SliceOptions options = this->options(out);
        options.model = path("small.obj").string();
        options.report = false;
        return options;
    }
    /// ... in cells so coarse that a loop takes no time.
    [[nodiscard]] SliceOptions looped(const std::string& out) const {
        SliceOptions options = small(out);
        options.predict_cell_mm = 0.3;
        options.iterations.assign(1, '2');
        return options;
    }
    void shards(SliceOptions options, int n) {
        for (int i = 1; i <= n; ++i) {
            options.shard = fmt::format("{}/{}", i, n);
            (void)print(options);
        }
    }
    [[nodiscard]] MergeOptions merging(const std::string& out, bool predict = false) const {
        MergeOptions options;
        options.out = path(out);
        options.predict = predict;
        return options;
    }
};

/// Cancels in the loop, and writes down what is expected and what somebody who stops is told.
class Watched final : public Progress, public ShowsOutlook {
public:
    explicit Watched(std::uint64_t stop_after = 0) : stop_after_(stop_after) {}
    void expect(std::vector<ExpectedStage> to_come) override { expected = std::move(to_come); }
    void expect_steps(std::uint64_t) override {}

    std::vector<ExpectedStage> expected;
    std::string advice_in_layers, notes;
    std::vector<std::string> stages;

private:
    void on_stage(std::string_view name, std::uint64_t, std::string_view) override {
        stages.emplace_back(name);
        if (name == name_of(Phase::layers)) advice_in_layers = stop_advice();
    }
    void on_advance(std::uint64_t done) override {
        if (stop_after_ > 0 && stages.back() == name_of(Phase::loop) && done == stop_after_) cancel();
    }
    void on_note(const std::string& note) override { notes += note + "\n"; }
    std::uint64_t stop_after_;
};

double seconds_of(const std::vector<ExpectedStage>& stages, Phase phase) {
    const auto found = std::ranges::find(stages, std::string(name_of(phase)), &ExpectedStage::name);
    return found == stages.end() ? -1 : found->seconds;
}

const json* section_of(const json& report, const std::string& title) {
    for (const json& section : report.at("sections"))
        if (section.at("title") == title) return &section;
    return nullptr;
}

double stage_seconds(const json& report, Phase phase) {
    double seconds = 0;
    for (const json& stage : report.at("stages"))
        if (stage.at("name") == std::string(name_of(phase))) seconds += stage.at("seconds").get<double>();
    return seconds;
}

}  // namespace

TEST_CASE("What an interrupted loop has saved is printed, gone on with or thrown away as is asked for") {
    BodyDesk desk;
    const SliceOptions options = desk.looped("out");
    Watched stopped(2);
    CHECK_THROWS_AS(run_print({options}, stopped), Error);
    const fs::path saved = desk.path("out/loop.checkpoint");
    REQUIRE(fs::exists(saved));
    SliceOptions none = options;
    none.iterations.assign(1, '0');
    CHECK_THROWS_WITH(desk.print(none), Contains("would throw away"));
    CHECK(fs::exists(saved));
    SliceOptions other = options;
    other.depth_mm = 0.5;
    other.resume = true;
    CHECK_THROWS_AS(desk.print(other), InputError);
    CHECK(fs::exists(saved));

    Watched on;
    (void)run_print({options}, on);
    CHECK_THAT(on.notes, Contains("holds the interrupted appearance loop of this very job: it goes on") &&
                             Contains("going on after iteration"));
    CHECK_THAT(on.advice_in_layers, Contains(saved.string()));  // until the stack is whole
    CHECK(stop_advice().empty());
    CHECK_FALSE(fs::exists(saved));
}

TEST_CASE("With --overwrite an interrupted loop begins anew") {
    BodyDesk desk;
    SliceOptions options = desk.looped("out");
    options.overwrite = true;
    Watched stopped(1), anew;
    CHECK_THROWS_AS(run_print({options}, stopped), Error);
    const fs::path saved = desk.path("out/loop.checkpoint");
    REQUIRE(fs::exists(saved));
    (void)run_print({options}, anew);
    CHECK_THAT(anew.notes, !Contains("goes on (") && !Contains("going on after"));
    CHECK_FALSE(fs::exists(saved));
    CHECK(std::ranges::count(anew.stages, std::string(name_of(Phase::loop))) == 1);
}

TEST_CASE("What a loop came to is kept where it was asked for, and nothing of one that was left out") {
    BodyDesk desk;
    SliceOptions without = desk.small("without");
    without.keep_loop = true;
    (void)desk.print(without);
    CHECK_FALSE(fs::exists(desk.path("without/skin.mixtures")));
    SliceOptions alone = desk.looped("alone");
    alone.iterations.assign(1, '1');
    alone.until = "loop";
    const JobResult kept = desk.print(alone);
    CHECK_THAT(kept.text, Contains("skin.mixtures"));
    CHECK_FALSE(fs::exists(desk.path("alone/manifest.json")));
    // The end of the same command without --until: its loop is not run again.
    alone.until = "end";
    Watched rest;
    (void)run_print({alone}, rest);
    CHECK(std::ranges::count(rest.stages, std::string(name_of(Phase::loop))) == 0);
    CHECK(fs::exists(desk.path("alone/manifest.json")));
    // Where the stack is there already, another loop is another thing to do.
    alone.until = "loop";
    alone.overwrite = true;
    CHECK_THAT(desk.print(alone).text, !Contains("nothing was done"));
    // Of another job it is refused before the model is read.
    SliceOptions other = desk.looped("alone");
    other.iterations.assign(1, '1');
    other.depth_mm = 0.5;
    other.mixtures = desk.path("alone/skin.mixtures").string();
    other.out = desk.path("other").string();
    Watched unread;
    CHECK_THROWS_AS(run_print({other}, unread), InputError);
    CHECK(unread.stages.empty());
    other.shard = "1/2";
    CHECK_THROWS_AS(run_print({other}, unread), InputError);
    CHECK(unread.stages.empty());
}

TEST_CASE("Some layers of a print are the whole's, counted as it counts them") {
    BodyDesk desk;
    (void)desk.print(desk.small("whole"));
    CHECK_THAT(desk.said.warnings(), !Contains("[few-layers]"));
    SliceOptions some = desk.small("some");
    some.layers = "8-36";  // one fewer than the printer takes
    const json report = json::parse(desk.print(some).json);
    CHECK(report.at("layers") == 29);
    CHECK_THAT(desk.said.warnings(), Contains("[few-layers]") && Contains("these 29 layers are a part of "));
    const StackVolume whole = read_stack_volume({.stack = desk.path("whole").string()}, desk.said),
                      part = read_stack_volume({.stack = desk.path("some").string()}, desk.said);
    REQUIRE(part.volume.size()[2] == 29);
    bool same = true;
    for (int z = 0; z < 29; ++z)
        for (int y = 0; y < part.volume.size()[1]; ++y)
            for (int x = 0; x < part.volume.size()[0]; ++x)
                same = same && part.volume.at(x, y, z) == whole.volume.at(x, y, z + 8);
    CHECK(same);
    CHECK(desk.json("some/manifest.json").at("first_layer") == 8);
    BodyDesk enough;
    some = enough.small("some");
    some.layers = "8-37";
    (void)enough.print(some);
    CHECK_THAT(enough.said.warnings(), !Contains("[few-layers]"));
    // A body that has not enough is refused, in shards too.
    enough.write_box("flat.obj", {1, 1, 0.7});
    SliceOptions flat = enough.small("flat");
    flat.model = enough.path("flat.obj").string();
    CHECK_THROWS_WITH(enough.print(flat), Contains("takes no fewer than 30"));
    flat.shard = "1/2";
    CHECK_THROWS_WITH(enough.print(flat), Contains("takes no fewer than 30") && Contains("larger (--size)"));
}

TEST_CASE("What a print takes is said before its layers are made: of a shard, its part of it") {
    BodyDesk desk;
    const SliceOptions options = desk.small("out");
    const JobEstimate estimate = estimate_print({options}, desk.said);
    Watched whole;
    (void)run_print({options}, whole);
    REQUIRE(io::has_hard_links(desk.path("out")));
    CHECK_THAT(whole.notes, Contains("the stack takes up to " + io::bytes_text(estimate.disk_bytes) + " of the") &&
                                Contains(fmt::format("{} layers of 27 um; ", estimate.layers)));
    const double layers_s = seconds_of(whole.expected, Phase::layers);
    CHECK(layers_s > 0);

    SliceOptions shard = desk.small("parts");
    shard.shard = "2/2";
    Watched part;
    (void)run_print({shard}, part);
    const io::ShardRecord made = io::read_shard(io::shard_file(desk.path("parts"), {2, 2}));
    REQUIRE((made.layers > 0 && made.layers < estimate.layers));
    CHECK(seconds_of(part.expected, Phase::layers) == Approx(layers_s * made.layers / estimate.layers).epsilon(1e-6));
    CHECK(part.expected.size() == 1);
    CHECK_THAT(part.notes, Contains("the stack takes up to ") &&
                               !Contains("the stack takes up to " + io::bytes_text(estimate.disk_bytes)));
}

TEST_CASE("A shard after the first takes the body as the first left it, but where a warning may stop it") {
    BodyDesk desk;
    SliceOptions options = desk.small("out");
    options.shard = "1/3";
    Watched first, second, strict, alone;
    (void)run_print({options}, first);
    const std::string job = io::read_shard(io::shard_file(desk.path("out"), {1, 3})).job;
    const fs::path kept = io::prepared_file(desk.path("out"), job);
    REQUIRE(fs::exists(kept));
    options.shard = "2/3";
    (void)run_print({options}, second);
    // Of which unit a model is taken to be is said where it is read.
    CHECK_THAT(first.notes, Contains("unit: "));
    CHECK_THAT(second.notes, !Contains("unit: "));
    fs::remove(kept);
    options.shard = "3/3";
    (void)run_print({options}, alone);
    CHECK_THAT(alone.notes, Contains("unit: "));
    CHECK(fs::exists(kept));
    CHECK_THAT(desk.said.warnings(), !Contains("[tiny]"));
    // The box is tiny, which is a warning.
    options.shard = "2/3";
    options.overwrite = true;
    options.strict = true;
    (void)run_print({options}, strict);
    CHECK_THAT(strict.notes, Contains("unit: "));
}

TEST_CASE("A merged report is told of its shards, and of what they found together") {
    BodyDesk desk;
    SliceOptions options = desk.options("out");
    options.predict = "transport";
    options.predict_cell_mm = 0.4;
    desk.shards(options, 3);
    double layers_s = 0, body_voxels = 0;
    std::size_t pictures = 0;
    for (std::uint32_t i = 1; i <= 3; ++i) {
        const io::ShardRecord record = io::read_shard(io::shard_file(desk.path("out"), {i, 3}));
        layers_s += record.figures.layers_s;
        body_voxels += double(record.figures.body_voxels);
        pictures += record.pictures.size();
    }
    CHECK(pictures > 0);
    const std::string job = io::read_shard(io::shard_file(desk.path("out"), {1, 3})).job;
    const json merged = json::parse(run_merge(desk.merging("out"), desk.said).json);
    CHECK(merged.at("voxels") == body_voxels);
    CHECK(stage_seconds(merged, Phase::layers) == Approx(layers_s).margin(0.01));
    CHECK_FALSE(merged.at("verdict").contains("seen_de2000"));
    CHECK_THAT(merged.dump(), Contains("merge --predict"));
    CHECK_FALSE(fs::exists(io::prepared_file(desk.path("out"), job)));
    REQUIRE(section_of(merged, "Shards"));
    const json& table = section_of(merged, "Shards")->at("tables")[0];
    CHECK(table.at("rows")[2][0] == "3/3");
    CHECK(table.at("rows")[1][3].get<std::string>().size() > 0);
    const std::string page = io::text_of(desk.path("out/report.html"));
    CHECK_THAT(page, Contains("voxel-data") && Contains("data:image"));
}

TEST_CASE("Merged with --predict a print is predicted as it is whole") {
    BodyDesk desk;
    SliceOptions options = desk.small("out");
    options.report = true;
    options.predict = "transport";
    options.predict_cell_mm = 0.4;
    SliceOptions whole = options;
    whole.out = desk.path("whole").string();
    const json before = json::parse(desk.print(whole).json);
    desk.shards(options, 2);
    const json merged = json::parse(run_merge(desk.merging("out", true), desk.said).json);
    REQUIRE(before.at("verdict").contains("seen_de2000"));
    CHECK(merged.at("verdict") == before.at("verdict"));
}

TEST_CASE("Of shards whose model has changed the stack is merged, and its report is refused") {
    BodyDesk desk;
    desk.shards(desk.small("out"), 2);
    desk.write_box("small.obj", {1, 1.2, 1.2});
    CHECK_THROWS_WITH(
        run_merge(desk.merging("out"), desk.said),
        Contains("the stack is merged and whole, but its report cannot be drawn") && Contains("--no-report"));
    CHECK(fs::exists(desk.path("out/manifest.json")));
    CHECK_FALSE(fs::exists(desk.path("out/report.json")));
    MergeOptions options = desk.merging("out");
    options.report = false;
    CHECK_THAT(run_merge(options, desk.said).text, Contains("merged already"));
}

TEST_CASE("A container is the same of shards as it is whole, with the body in its preview") {
    BodyDesk desk;
    SliceOptions options = desk.small("whole");
    options.formats = {"gcvf"};
    (void)desk.print(options);
    options.out = desk.path("parts").string();
    desk.shards(options, 2);
    MergeOptions merging = desk.merging("parts");
    merging.report = false;
    (void)run_merge(merging, desk.said);
    const std::string whole = io::text_of(desk.path("whole/stack.gcvf"));
    CHECK(whole.size() > 1000);
    CHECK((io::text_of(desk.path("parts/stack.gcvf")) == whole));
}
