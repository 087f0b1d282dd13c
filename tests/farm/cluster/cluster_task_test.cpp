// SPDX-License-Identifier: GPL-3.0-or-later
//
// A task of a cluster, with scripts in the place of the program and of Slurm's.
#include "farm/cluster/cluster_task.h"

#include <chrono>
#include <thread>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "farm/batch/batch_folder.h"
#include "farm/cluster/job_record.h"
#include "farm/cluster/submission.h"
#include "slicer/part/loop_checkpoint.h"
#include "stand_ins.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// A job of one stage, `whole`, that was handed to Slurm as its job 17.
struct Workshop {
    explicit Workshop(const std::string& program) : batch(BatchFolder::make(slurm.at("out"))) {
        slurm.program("program", "echo \"$@\" >>$AT/run\n" + program);
        slurm.program("scontrol", "echo \"$@\" >>$AT/asked");
        slurm.program("a.obj", "");
        PlannedJob job;
        job.name = "a";
        job.options.model = slurm.at("a.obj").string();
        job.options.out = (slurm.at("out") / "a").string();
        SubmissionFolder(batch).write_job(job);
        SubmissionFolder(batch).write(submission());
        JobState state;
        state.name = "a";
        batch.publish(state);
        options.out = slurm.at("out");
        options.program = slurm.at("program");
        options.job = "a";
        options.requeue_patience_s = 0;
    }
    static Submission submission() {
        return {"a", "2026-11-26T12:00:00Z", 0, true, {{TaskStage::whole, {"slice", "a.obj"}, 1, {"17"}}}, 1};
    }
    [[nodiscard]] JobState state() const { return *batch.state_of("a"); }

    StandIns slurm;
    BatchFolder batch;
    TaskOptions options;
    Progress progress;
};

class KeepsNothing final : public optics::AppearanceSequence {
    [[nodiscard]] optics::Appearance next(const optics::ResinVolume&, const Progress*) override { return {}; }
    void write_state(const StateSink&) const override {}
};

class Warnings final : public Progress {
public:
    std::string all;

private:
    void on_warning(const std::string& message) override { all += message + '\n'; }
};

}  // namespace

TEST_CASE("A task that may go another time puts back its own allocation, and no other that it runs in") {
    Workshop shop("echo 'voxtone: the disk is full'\nexit 75\n");
    {
        const SlurmEnvironment none({}, {}, {});
        CHECK(run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::try_again);
    }
    {  // by hand, or of a render manager whose worker is a job of Slurm's
        const SlurmEnvironment foreign("18", {}, {}, "9");
        CHECK(run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::try_again);
    }
    {
        const SlurmEnvironment foreign_array("17", "16", "17", "9");
        CHECK(run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::try_again);
    }
    CHECK_FALSE(fs::exists(shop.slurm.at("asked")));
    CHECK(shop.state().attempts == 1);  // what others were put back is not counted
    const SlurmEnvironment own("17", {}, {}, "1");
    CHECK(run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::try_again);
    CHECK(shop.slurm.text("asked") == "requeue 17\n");
    CHECK(shop.state().attempts == 2);
    CHECK(shop.state().phase == JobPhase::queued);
    CHECK(shop.state().message == "whole: the disk is full");
}

TEST_CASE("A task that was put back often enough ends so that nobody tries it again") {
    Workshop shop("echo 'voxtone: the disk is full'\nexit 75\n");
    shop.options.retries = 2;
    const SlurmEnvironment last("17", {}, {}, "2");
    const JobResult result = run_cluster_task(shop.options, shop.progress);
    CHECK(result.exit_code == ExitCode::unfinished);
    CHECK_FALSE(fs::exists(shop.slurm.at("asked")));
    CHECK(shop.state().phase == JobPhase::failed);
    CHECK(shop.state().exit_code == 75);
    CHECK(shop.state().message == "the disk is full (after 3 attempts)");
}

TEST_CASE(
    "A task that came further in its time is put back however often, one that did not a bounded number of times") {
    // Saves one step more of its loop each time until the fourth.
    Workshop shop(
        "n=$(cat $AT/n 2>/dev/null || echo 0); n=$((n + 1)); echo $n >$AT/n\nmkdir -p $AT/out/a\n"
        "cp $AT/$((n > 4 ? 4 : n))/loop.checkpoint $AT/out/a\necho 'voxtone: stopped on request'\nexit 85\n");
    for (std::size_t steps = 1; steps <= 4; ++steps) {
        const fs::path folder = shop.slurm.at(std::to_string(steps));
        fs::create_directory(folder);
        halftone::LoopState state;
        state.steps.resize(steps);
        LoopCheckpoint(folder, "a", "b", {}).write(state, KeepsNothing());
    }
    shop.options.retries = 1;
    std::string ended;
    for (int restarts = 0; restarts < 8 && ended.empty(); ++restarts) {
        const SlurmEnvironment own("17", {}, {}, std::to_string(restarts));
        if (run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::unfinished)
            ended = std::to_string(restarts);
    }
    CHECK(ended == "5");
    CHECK(shop.state().phase == JobPhase::failed);
    CHECK_THAT(shop.state().message, Contains("after 6 attempts, of which 4 came further"));
}

TEST_CASE("A task whose time is over goes again where it keeps what it did, and else says what to give it") {
    const auto message_of = [](std::string_view iterations, const std::string& left, int retries) {
        Workshop shop("exec sleep 30\n");
        shop.slurm.program("squeue", "echo \"$@\" >>$AT/asked\necho '" + left + " 22:00'");
        PlannedJob job = handed_over_job(shop.batch, "a");
        job.options.iterations = iterations;
        SubmissionFolder(shop.batch).write_job(job);
        shop.options.retries = retries;
        shop.progress.cancel();  // as SIGTERM does
        const SlurmEnvironment own("17", {}, {}, "1");
        const JobResult result = run_cluster_task(shop.options, shop.progress);
        CHECK((result.exit_code == ExitCode::unfinished) == (shop.state().phase == JobPhase::failed));
        return shop.slurm.text("asked") + shop.state().message;
    };
    const std::string more = "its time is over, 22 min; hand it over again with more: --sbatch-option time=44";
    const std::string without_loop = message_of("0", "0:58", 5);
    CHECK_THAT(without_loop, Contains("--jobs=17") && Contains(more) && !Contains("requeue"));
    CHECK_THAT(message_of("auto", "0:58", 5), Contains("requeue 17") && !Contains(more));
    CHECK_THAT(message_of("auto", "0:58", 1), Contains("after 2 attempts") && Contains(more));
    // Stopped for another reason, or by one that says nothing of time.
    for (const char* left : {"15:00", "1-00:00:00", "UNLIMITED", ""})
        CHECK_THAT(message_of("0", left, 5), Contains("requeue 17") && !Contains("time="));
    // Who is cancelled stays so.
    CHECK_THAT(message_of("auto", "CG 15:00", 5), !Contains("requeue"));
}

TEST_CASE("A task that is for a person to mend says so, and its words stay in a file of its own") {
    Workshop shop("echo 'voxtone: no model'\nexit 3\n");
    const SlurmEnvironment own("17", {}, {});
    CHECK(run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::invalid_input);
    CHECK(shop.state().message == "no model");
    CHECK_FALSE(fs::exists(shop.slurm.at("asked")));
    const fs::path log = SubmissionFolder(shop.batch).task_log("a", TaskStage::whole, 1);
    REQUIRE(fs::exists(log));
    CHECK_FALSE(fs::exists(shop.batch.log_file("a")));
    const auto size = fs::file_size(log);
    (void)run_cluster_task(shop.options, shop.progress);
    CHECK(fs::file_size(log) > size);
}

TEST_CASE("A task that begins before its submission is noted waits for that") {
    Workshop shop("exit 3\n");
    Submission incomplete = Workshop::submission();
    incomplete.complete = false;
    incomplete.stages.clear();
    SubmissionFolder(shop.batch).write(incomplete);
    auto lock = shop.batch.lock("a");
    REQUIRE(lock);
    std::thread handing_over([&] {
        SubmissionFolder(shop.batch).write(Workshop::submission());
        lock.reset();
    });
    CHECK(run_cluster_task(shop.options, shop.progress).exit_code == ExitCode::invalid_input);
    handing_over.join();
    CHECK(shop.slurm.text("run") == "slice a.obj\n");
}

TEST_CASE("However many tasks end, the summary is drawn at times") {
    const Workshop shop("");
    Progress progress;
    const fs::path page = shop.batch.path() / "index.html";
    const auto age_of_page = [&](int seconds) {
        fs::last_write_time(page, fs::last_write_time(shop.batch.state_file("a")) - std::chrono::seconds(seconds));
        return fs::last_write_time(page);
    };
    summarise_at_times(shop.batch, "a", 10, progress);
    REQUIRE(fs::exists(page));
    auto before = age_of_page(30);
    summarise_at_times(shop.batch, "a", 10, progress);
    CHECK(fs::last_write_time(page) == before);
    before = age_of_page(90);
    summarise_at_times(shop.batch, "a", 10'000, progress);  // of so many a summary takes long
    CHECK(fs::last_write_time(page) == before);
    summarise_at_times(shop.batch, "a", 10, progress);
    CHECK(fs::last_write_time(page) > before);
    before = age_of_page(90);
    const auto another = shop.batch.lock_summary();
    summarise_at_times(shop.batch, "a", 10, progress);
    CHECK(fs::last_write_time(page) == before);
}

TEST_CASE("Of a batch whose queue cannot be asked no job is taken for one that still runs") {
    const Workshop shop("");
    shop.slurm.program("squeue", "echo 'squeue: error: no configuration source' >&2; exit 1");
    Warnings warnings;
    CHECK(close_cluster_batch(shop.slurm.at("out"), warnings).exit_code == ExitCode::done);
    CHECK_THAT(warnings.all, Contains("finds no cluster") && Contains("[queue-unknown]") && !Contains("submitted"));
    CHECK(shop.state().phase == JobPhase::failed);
    CHECK_THAT(shop.state().message, Contains("its tasks ended before it was done"));
}

TEST_CASE("A state that another host may write too is changed, and one that cannot be written is told") {
    const Workshop shop("");
    Warnings warnings;
    const auto change = [&](int attempts) {
        change_state(shop.batch, "a", warnings, [&](JobState& state) { state.attempts = attempts; });
    };
    change(3);
    CHECK(warnings.all.empty());
    std::ofstream(shop.batch.state_file("a").parent_path() / ".a.lock")
        << "node-17 4711 99 2026-11-26T12:00:00Z 0123abcd\n";
    change(4);
    CHECK_THAT(warnings.all, Contains("node-17") && Contains("[lock-doubt]"));
    CHECK(shop.state().attempts == 4);

    warnings.all.clear();
    fs::remove(shop.batch.state_file("a"));
    fs::create_directories(shop.batch.state_file("a") / "a folder in its place");
    change(5);
    CHECK_THAT(warnings.all, Contains("a: its state could not be noted") && Contains("[not-noted]"));
}
