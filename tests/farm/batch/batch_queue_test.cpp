// SPDX-License-Identifier: GPL-3.0-or-later
//
// A batch's queue, with a shell's script in the place of the program.
#include "farm/batch/batch_queue.h"

#include <algorithm>
#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "farm/batch/batch_status.h"
#include "farm/batch/batch_summary.h"
#include "farm/batch/job_result.h"
#include "io/programs/build_identity.h"
#include "slicer/options/job_file.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/loop_checkpoint.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Kind = JobEvent::Kind;
namespace fs = std::filesystem;

namespace {

class Events final : public BatchView {
public:
    void notify(const JobEvent& event) override { all.push_back(event); }
    [[nodiscard]] std::vector<JobEvent> of(Kind kind) const {
        std::vector<JobEvent> found;
        std::copy_if(all.begin(), all.end(), std::back_inserter(found),
                     [&](const JobEvent& event) { return event.kind == kind; });
        return found;
    }
    std::vector<JobEvent> all;
};

struct Workshop {
    /// `script`: of the program; $OUT is the workshop's folder.
    explicit Workshop(const std::string& script) {
        std::ofstream(folder.path() / "program")
            << fmt::format("#!/bin/sh\nOUT='{}'\n", folder.path().string()) << script;
        fs::permissions(folder.path() / "program", fs::perms::owner_all);
        std::ofstream(folder.path() / "a.obj") << "";
        options.out = folder.path() / "out";
        options.program = folder.path() / "program";
        options.backoff_s = 0.001;
        options.cores = 4;
        options.memory_bytes = std::uint64_t{1} << 50;
    }
    [[nodiscard]] PlannedJob job(const std::string& name) const {
        PlannedJob planned;
        planned.name = name;
        planned.options.model = (folder.path() / "a.obj").string();
        planned.options.iterations = "0";
        planned.options.predict = "none";
        planned.out = options.out / name;
        planned.options.out = planned.out.string();
        planned.command = {"slice", planned.options.model};
        return planned;
    }
    [[nodiscard]] std::string said() const {
        std::ifstream in(folder.path() / "said");
        return {std::istreambuf_iterator<char>(in), {}};
    }
    io::TemporaryFolder folder;
    BatchOptions options;
};

/// A queue and what it shares.
struct Batch {
    explicit Batch(const Workshop& shop)
        : folder(BatchFolder::make(shop.options.out)),
          context{shop.options, folder, events, progress},
          queue(context) {}
    void run() {
        while (queue.step()) at_once = std::max(at_once, queue.snapshot(false).running.size());
    }
    BatchFolder folder;
    Events events;
    Progress progress;
    BatchContext context;
    BatchQueue queue;
    std::size_t at_once = 0;
};

}  // namespace

TEST_CASE("A job that may go another time is begun once and so many times again as is allowed") {
    Workshop shop("echo 'voxtone: the disk is full'\nexit 75\n");
    shop.options.retries = 2;
    Batch batch(shop);
    batch.queue.add(shop.job("a"));
    batch.run();
    const auto started = batch.events.of(Kind::started);
    REQUIRE(started.size() == 3);
    for (int i = 0; i < 3; ++i) CHECK(started[std::size_t(i)].attempt == i + 1);
    CHECK(batch.events.of(Kind::again).size() == 2);
    const auto failed = batch.events.of(Kind::failed);
    REQUIRE(failed.size() == 1);
    CHECK(failed[0].message == "the disk is full (after 3 attempts)");
    CHECK(failed[0].exit_code == 75);
    const auto state = batch.folder.state_of("a");
    REQUIRE(state);
    CHECK(state->phase == JobPhase::failed);
    CHECK(state->attempts == 3);
}

TEST_CASE("What is for a person to mend is begun once, and stops no other") {
    Workshop shop("case \"$2\" in bad) echo 'voxtone: no model'; exit 3;; esac\nkill -9 $$\n");
    shop.options.retries = 1;
    Batch batch(shop);
    PlannedJob bad = shop.job("bad");
    bad.command[1] = "bad";
    batch.queue.add(bad);
    batch.queue.add(shop.job("killed"));
    batch.run();
    CHECK(batch.events.of(Kind::started).size() == 3);
    CHECK(batch.folder.state_of("bad")->exit_code == 3);
    CHECK(batch.folder.state_of("bad")->message == "no model");
    CHECK_THAT(batch.folder.state_of("killed")->message, Contains("signal 9") && Contains("after 2 attempts"));
}

TEST_CASE("No more jobs run at once than are allowed, and cores are shared among those that do") {
    Workshop shop("echo \"$@\" >>$OUT/said\nexit 3\n");
    shop.options.jobs = 2;
    Batch batch(shop);
    for (const char* name : {"a", "b", "c", "d", "e"}) batch.queue.add(shop.job(name));
    batch.run();
    CHECK(batch.at_once <= 2);
    for (const JobEvent& event : batch.events.of(Kind::started)) {
        CHECK(event.threads >= 2);
        CHECK(event.threads <= 4);
    }
    CHECK(batch.queue.ended() == 5);
}

TEST_CASE("What another batch has made of a job since is its batch's, and may be made again") {
    const Workshop shop("echo \"$@\" >>$OUT/said\nexit 3\n");
    Batch batch(shop);
    fs::create_directories(shop.options.out / "a");
    std::ofstream(shop.options.out / "a/foreign") << "";
    batch.queue.add(shop.job("a"));
    REQUIRE(batch.folder.state_of("a"));
    CHECK_FALSE(batch.folder.state_of("a")->folder_is_ours);
    // Its owner clears the folder; another batch takes it, and is killed in the midst of its work.
    fs::remove(shop.options.out / "a/foreign");
    JobState others = *batch.folder.state_of("a");
    others.folder_is_ours = true;
    batch.folder.publish(others);
    std::ofstream(shop.options.out / "a/left") << "";
    batch.run();
    CHECK_THAT(shop.said(), Contains("--overwrite"));
    CHECK(batch.folder.state_of("a")->folder_is_ours);
}

TEST_CASE("What another version of the program made is made anew over it, what this one made is kept") {
    const Workshop shop("echo \"$@\" >>$OUT/said\nexit 3\n");
    const PlannedJob job = shop.job("a");
    const bool another = GENERATE(false, true);
    CAPTURE(another);
    Batch batch(shop);
    fs::create_directories(job.out);
    std::ofstream(job.out / "manifest.json") << "{}";
    std::ofstream(job.out / "report.json") << "{}";
    std::ofstream(job.out / "job.json") << job_record(job.options, identify(open_job(job.options), {}).inputs, job.out);
    JobState done;
    done.name = job.name;
    done.phase = JobPhase::done;
    done.command = job.command;
    done.program = another ? "0.0.9" : io::build_identity();
    done.folder_is_ours = true;
    batch.folder.publish(done);
    batch.queue.add(job);
    batch.run();
    CHECK(batch.events.of(Kind::unchanged).size() == (another ? 0 : 1));
    CHECK(batch.events.of(Kind::started).size() == (another ? 1 : 0));
    CHECK((shop.said().find("--overwrite") != std::string::npos) == another);
}

TEST_CASE("A folder that no batch has made is not replaced") {
    const Workshop shop("echo \"$@\" >>$OUT/said\nexit 3\n");
    Batch batch(shop);
    fs::create_directories(shop.options.out / "a");
    std::ofstream(shop.options.out / "a/foreign") << "";
    batch.queue.add(shop.job("a"));
    batch.run();
    CHECK_THAT(shop.said(), Contains("slice") && !Contains("--overwrite"));
}

TEST_CASE("What runs when a batch is stopped waits for the next, however often it was tried") {
    Workshop shop("touch $OUT/runs\ntrap 'exit 85' TERM\nwhile :; do sleep 0.01; done\n");
    shop.options.retries = 0;
    Batch batch(shop);
    batch.queue.add(shop.job("a"));
    while (!fs::exists(shop.folder.path() / "runs")) REQUIRE(batch.queue.step());
    batch.queue.stop();
    CHECK(batch.events.of(Kind::stopped).size() == 1);
    CHECK(batch.events.of(Kind::failed).empty());
    const auto state = batch.folder.state_of("a");
    REQUIRE(state);
    CHECK(state->phase == JobPhase::queued);
    CHECK(state->exit_code == 85);
    CHECK_FALSE(state->runner);
}

namespace {

class KeepsNothing final : public optics::AppearanceSequence {
    [[nodiscard]] optics::Appearance next(const optics::ResinVolume&, const Progress*) override { return {}; }
    void write_state(const StateSink&) const override {}
};

/// What `slice` leaves: a stack with a report that has these warnings.
std::string program_with_warnings(const std::string& warnings) {
    return fmt::format(R"(
mkdir -p $OUT/out/a
echo '{{"content_sha256": ""}}' >$OUT/out/a/manifest.json
echo '{{"format": "voxtone-job", "version": 1, "inputs": []}}' >$OUT/out/a/job.json
echo '{{"printer": {{"id": "x"}}, "size_mm": [1, 1, 1], "layers": 1, "voxels": 1, "warnings": [{}], "resins": [],
  "seconds": 30, "peak_memory_bytes": 1, "output_bytes": 1}}' >$OUT/out/a/report.json
)",
                       warnings);
}

}  // namespace

TEST_CASE("Colours that a print has lost are told where the batch is watched, in its state, and to what follows") {
    const std::string lost = "The texture t.png was not found: its colours are LOST. [lost-colour]";
    const bool is_lossy = GENERATE(true, false);
    Workshop shop(program_with_warnings(is_lossy ? "\"tiny. [tiny]\", \"" + lost + "\"" : "\"tiny. [tiny]\""));
    shop.options.after = "echo \"$VOXTONE_JOB <$VOXTONE_LOST_COLOURS>\" >>" + (shop.folder.path() / "said").string();
    Batch batch(shop);
    batch.queue.add(shop.job("a"));
    batch.run();
    const auto warned = batch.events.of(Kind::warned);
    REQUIRE(warned.size() == (is_lossy ? 1 : 0));
    if (is_lossy) CHECK(warned[0].message == lost);
    CHECK(shop.said() == (is_lossy ? "a <" + lost + ">\n" : "a <>\n"));
    const auto state = batch.folder.state_of("a");
    REQUIRE(state);
    CHECK(state->phase == JobPhase::done);
    CHECK(lost_colours(*state->figures).size() == (is_lossy ? 1 : 0));
    CHECK((state_json(*state).find("\"lost_colours\"") != std::string::npos) == is_lossy);
    CHECK((batch_status(shop.options.out).text.find("LOST colours") != std::string::npos) == is_lossy);
    const std::string csv = batch_csv({*state});
    CHECK_THAT(csv, Contains(",lost_colours,"));
    CHECK((csv.find(lost) != std::string::npos) == is_lossy);
    CHECK((batch_html(batch.folder, {*state}).find("colours are LOST</summary>") != std::string::npos) == is_lossy);
}

TEST_CASE("Tries after which the loop is further do not count as retries") {
    // One step more at each try but the last two.
    Workshop shop(R"(
n=$(cat $OUT/n 2>/dev/null || echo 0)
n=$((n + 1))
echo $n >$OUT/n
mkdir -p $OUT/out/a
cp $OUT/$((n > 5 ? 5 : n))/loop.checkpoint $OUT/out/a
exit 85
)");
    for (std::size_t steps = 1; steps <= 5; ++steps) {
        const fs::path folder = shop.folder.path() / std::to_string(steps);
        fs::create_directory(folder);
        halftone::LoopState state;
        state.steps.resize(steps);
        LoopCheckpoint(folder, "a", "b", {}).write(state, KeepsNothing());
    }
    shop.options.retries = 1;
    Batch batch(shop);
    batch.queue.add(shop.job("a"));
    batch.run();
    CHECK(batch.events.of(Kind::started).size() == 7);
    const auto failed = batch.events.of(Kind::failed);
    REQUIRE(failed.size() == 1);
    CHECK_THAT(failed[0].message, Contains("after 7 attempts, of which 5 came further"));
    CHECK(batch.folder.state_of("a")->attempts_that_got_on == 5);
}

TEST_CASE("Jobs are estimated while they wait, where that is little beside what they take") {
    // Two outcomes of a stack that `slice` would leave, and what `estimate --json` says at last.
    const std::string program = R"(
case "$1" in estimate)
  echo estimate >>$OUT/said
  echo '{"event":"result","result":{"format": "voxtone-estimate", "cpu_seconds": 123.5, "memory_bytes": 1000}}'
  exit 0;;
esac
[ "$2" = bad ] && exit 3
mkdir -p $OUT/out/a
echo '{"content_sha256": ""}' >$OUT/out/a/manifest.json
echo '{"format": "voxtone-job", "version": 1, "inputs": []}' >$OUT/out/a/job.json
echo '{"printer": {"id": "x"}, "size_mm": [1, 1, 1], "layers": 1, "voxels": 1, "warnings": [], "resins": [],
  "seconds": 30, "peak_memory_bytes": 1, "output_bytes": 1}' >$OUT/out/a/report.json
)";
    for (const double from_s : {25.0, 35.0}) {
        Workshop shop(program);
        shop.options.jobs = 1;
        shop.options.estimate_from_s = from_s;
        Batch batch(shop);
        for (const char* name : {"a", "b", "c"}) {
            PlannedJob job = shop.job(name);
            if (job.name != "a") job.command[1] = "bad";
            batch.queue.add(job);
        }
        batch.run();
        CHECK(batch.folder.state_of("a")->phase == JobPhase::done);
        const bool worth_it = from_s < 30;
        CHECK(batch.folder.state_of("c")->expected_cpu_s == (worth_it ? 123.5 : 0));
        CHECK((shop.said() == "estimate\n" || shop.said() == "estimate\nestimate\n") == worth_it);
        CHECK(batch.folder.state_of("c")->phase == JobPhase::failed);
    }
}

TEST_CASE(
    "One after the other, or until the first that fails, jobs begin in the order of the plan, whatever must be "
    "weighed") {
    Workshop shop(R"(
case "$1" in estimate)
  until [ -e $OUT/go ]; do sleep 0.01; done
  echo '{"event":"result","result":{"format": "voxtone-estimate", "cpu_seconds": 1, "memory_bytes": 1000}}'
  exit 0;;
esac
exit 3
)");
    const bool fail_fast = GENERATE(false, true);
    shop.options.jobs = GENERATE(0, 1);
    shop.options.fail_fast = fail_fast;
    CAPTURE(fail_fast, shop.options.jobs);
    Batch batch(shop);
    PlannedJob first = shop.job("first");
    first.options.iterations = "auto";  // of a size that nobody told: its memory is estimated before it begins
    batch.queue.add(first);
    batch.queue.add(shop.job("second"));
    const auto begun = [&] {
        std::vector<std::string> names;
        for (const JobEvent& event : batch.events.of(Kind::started)) names.push_back(event.name);
        return names;
    };
    REQUIRE(batch.queue.step());
    const bool in_order = fail_fast || shop.options.jobs == 1;
    CHECK(begun() == (in_order ? std::vector<std::string>{} : std::vector<std::string>{"second"}));
    std::ofstream(shop.folder.path() / "go") << "";
    batch.run();
    REQUIRE_FALSE(begun().empty());
    CHECK(begun().front() == (in_order ? "first" : "second"));
    if (!fail_fast) CHECK(begun().size() == 2);
}

TEST_CASE("What an input held is known of one that was last changed long before the job began, and of no other") {
    const io::TemporaryFolder folder;
    const std::string model = (folder.path() / "a.obj").string();
    std::ofstream(model) << "v 0 0 0\n";
    SliceOptions options;
    options.model = model;
    const std::vector<JobInput> inputs{{"model", model, std::string(64, 'a')}};
    std::ofstream(folder.path() / "job.json") << job_record(options, inputs, folder.path());
    const auto stamp = io::FileStamp::of(model);
    REQUIRE(stamp);
    constexpr std::int64_t second = 1'000'000'000;
    io::FileDigests young, old;
    learn_inputs(folder.path(), stamp->changed_ns + second, young);
    CHECK_FALSE(young.find(model));
    CHECK(known_inputs(folder.path(), young).empty());
    learn_inputs(folder.path(), stamp->changed_ns + 3 * second, old);
    REQUIRE(old.find(model));
    CHECK(old.find(model)->sha256 == std::string(64, 'a'));
    REQUIRE(known_inputs(folder.path(), old).size() == 1);
    CHECK(known_inputs(folder.path(), old)[0].first == model);
}
