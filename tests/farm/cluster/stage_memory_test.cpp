// SPDX-License-Identifier: GPL-3.0-or-later
//
// What Slurm did to a job while none of ours could say so: ended it for memory, or holds it back.
#include "farm/cluster/stage_memory.h"

#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "farm/batch/batch_status.h"
#include "farm/cluster/cluster_task.h"
#include "farm/cluster/held_jobs.h"
#include "farm/cluster/job_record.h"
#include "stand_ins.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t mib = std::uint64_t{1} << 20;

/// A job `a` of two stages that was handed to Slurm as its jobs 17 and 18, and of which nothing is left in its queue.
struct HandedOver {
    HandedOver() : batch(BatchFolder::make(slurm.at("out"))), files(batch) {
        slurm.program("squeue", "");
        slurm.program("scontrol", "exit 1");
        slurm.program("a.obj", "");
        PlannedJob job;
        job.name = "a";
        job.options.model = slurm.at("a.obj").string();
        job.options.out = (slurm.at("out") / "a").string();
        files.write_job(job);
        Submission submission{"a", "2026-11-26T12:00:00Z", 0, true, {}, 1};
        submission.stages.push_back({TaskStage::prepare, {"slice"}, 1, {"17"}, 100 * mib, false, false});
        submission.stages.push_back({TaskStage::layers, {"slice"}, 3, {"18"}, 200 * mib, false, false});
        files.write(submission);
        JobState state;
        state.name = "a";
        state.phase = JobPhase::running;
        batch.publish(state);
    }
    void slurm_writes(const std::string& file, const std::string& text) const {
        std::ofstream(files.of("a") / file, std::ios::app) << text << "\n";
    }
    [[nodiscard]] JobState closed() {
        (void)close_cluster_batch(slurm.at("out"), progress);
        return *batch.state_of("a");
    }
    StandIns slurm;
    BatchFolder batch;
    SubmissionFolder files;
    Progress progress;
};

const std::string over_limit =
    "slurmstepd-node-3: error: StepId=18.batch exceeded memory limit (312000 > 204800), being killed";

}  // namespace

TEST_CASE("Slurm's words for too little memory are known, and no others are taken for them") {
    for (const std::string& text :
         {over_limit, std::string("slurmstepd: error: Exceeded job memory limit at some point."),
          std::string("slurmstepd: error: Detected 1 oom-kill event(s) in StepId=18.batch. Some of your processes may "
                      "have been killed by the cgroup out-of-memory handler."),
          std::string("slurmstepd: error: Detected 2 oom_kill events in StepId=7.0. Some of the step tasks have been "
                      "OOM Killed.")})
        CHECK(tells_of_too_little_memory(text));
    for (const char* text :
         {"", "slurmstepd: error: *** JOB 17 ON node CANCELLED AT 2026-11-26T12:00:00 DUE TO TIME LIMIT ***",
          "voxtone: needs 4 GiB of memory, allow more (--memory)"})
        CHECK_FALSE(tells_of_too_little_memory(text));
}

TEST_CASE("A job that Slurm ended for memory says so, and is handed over again with twice as much") {
    HandedOver job;
    job.slurm_writes("prepare.17.out", "a: prepare: done");
    job.slurm_writes("layers.18_2.out", over_limit);
    job.slurm_writes("layers.180_2.out", over_limit);  // another's
    const JobState state = job.closed();
    CHECK(state.phase == JobPhase::failed);
    CHECK(state.exit_code == 5);
    CHECK_THAT(state.message,
               Contains("layers: Slurm ended it for memory") && Contains("200 MiB") && Contains("twice as much"));
    const Submission noted = *job.files.read("a");
    CHECK_FALSE(noted.stages[0].is_starved);
    CHECK(noted.stages[1].is_starved);

    const auto chain_of = [] {
        TaskChain chain;
        for (const TaskStage stage : {TaskStage::prepare, TaskStage::layers, TaskStage::merge}) {
            ChainStage& one = chain.stages.emplace_back();
            one.stage = stage;
            one.memory_bytes = 150 * mib;
        }
        return chain;
    };
    TaskChain again = chain_of();
    CHECK_THAT(give_more_memory(again, noted), Contains("layers is given 400 MiB"));
    CHECK(again.stages[0].memory_bytes == 150 * mib);
    CHECK(again.stages[1].memory_bytes == 400 * mib);
    CHECK(again.stages[1].is_raised);
    CHECK(again.stages[2].memory_bytes == 150 * mib);
    // What was raised stays so when it is handed over for another reason, and doubles again for the same.
    Submission second = noted;
    second.stages[1].memory_bytes = 400 * mib;
    second.stages[1].is_starved = false;
    second.stages[1].is_raised = true;
    TaskChain third = chain_of();
    CHECK_FALSE(give_more_memory(third, second).empty());
    CHECK(third.stages[1].memory_bytes == 400 * mib);
    second.stages[1].is_starved = true;
    third = chain_of();
    CHECK_FALSE(give_more_memory(third, second).empty());
    CHECK(third.stages[1].memory_bytes == 800 * mib);
    // Of one that nothing happened to, and where the estimate asks for more now.
    second.stages[1].is_starved = second.stages[1].is_raised = false;
    third = chain_of();
    CHECK(give_more_memory(third, second).empty());
    second.stages[1].is_starved = true;
    third.stages[1].memory_bytes = 1000 * mib;
    CHECK(give_more_memory(third, second).empty());
    CHECK(third.stages[1].memory_bytes == 1000 * mib);
}

TEST_CASE("The state OUT_OF_MEMORY says the same where the output is silent") {
    HandedOver job;
    job.slurm.program("scontrol", "case \"$4\" in 17) echo 'JobId=17 JobState=OUT_OF_MEMORY';; *) exit 1;; esac");
    CHECK_THAT(job.closed().message, Contains("prepare: Slurm ended it for memory") && Contains("100 MiB"));
    CHECK(job.files.read("a")->stages[0].is_starved);
}

TEST_CASE("A job that ended otherwise is told as before") {
    HandedOver job;
    job.slurm_writes("prepare.17.out", "slurmstepd: error: *** JOB 17 CANCELLED DUE TO TIME LIMIT ***");
    const JobState state = job.closed();
    CHECK(state.exit_code == 75);
    CHECK_THAT(state.message, Contains("its tasks ended before it was done"));
    CHECK_FALSE(job.files.read("a")->stages[0].is_starved);
}

TEST_CASE("A job that is held in the queue says so, and how it is let go") {
    HandedOver job;
    job.slurm.program("squeue", "echo '17 PD JobHeldUser'; echo '18 PD Dependency'");
    CHECK_THAT(held_jobs(job.slurm.at("out")).at("a"), Contains("held") && Contains("`scontrol release 17`"));
    const std::string status = batch_status(job.slurm.at("out"), held_jobs(job.slurm.at("out"))).text;
    CHECK_THAT(status, Contains("JobHeldUser") && Contains("scontrol release 17") && !Contains("administrator"));
    job.slurm.program("squeue", "echo '18 PD JobHeldAdmin'");
    CHECK_THAT(held_jobs(job.slurm.at("out")).at("a"), Contains("scontrol release 18") && Contains("administrator"));
    job.slurm.program("squeue", "echo '17 SE None'");
    CHECK_THAT(held_jobs(job.slurm.at("out")).at("a"), Contains("scontrol release 17"));
    for (const char* other : {"echo '17 PD Resources'", "echo '19 PD JobHeldUser'", "exit 1", ""}) {
        job.slurm.program("squeue", other);
        CHECK(held_jobs(job.slurm.at("out")).empty());
    }
    // Of what is done nothing is asked.
    job.slurm.program("squeue", "touch $AT/asked");
    JobState state = *job.batch.state_of("a");
    state.phase = JobPhase::done;
    job.batch.publish(state);
    CHECK(held_jobs(job.slurm.at("out")).empty());
    CHECK_FALSE(fs::exists(job.slurm.at("asked")));
}
