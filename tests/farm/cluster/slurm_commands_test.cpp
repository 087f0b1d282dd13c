// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/slurm_commands.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "farm/cluster/command_output.h"
#include "stand_ins.h"

using namespace voxtone;
using namespace voxtone::farm;
using Catch::Matchers::Contains;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

std::string submit(const StandIns& slurm, const std::string& sbatch) {
    slurm.program("sbatch", sbatch);
    return submit_to_slurm(Words{"script"});
}

}  // namespace

TEST_CASE("The configuration's longest array is read, wherever it stands") {
    const StandIns slurm;
    slurm.program("scontrol", "echo 'ClusterName = x'; echo 'MaxArraySize            = 31'; echo 'MaxJobCount = 9'");
    CHECK(slurm_config().max_array_size == 31);
    slurm.program("scontrol", "echo 'MaxArraySize = 0'");
    CHECK(slurm_config().max_array_size == 0);
    slurm.program("scontrol", "echo 'ClusterName = x'");
    CHECK(slurm_config().max_array_size == 1001);
    slurm.program("scontrol", "echo 'Unable to contact slurm controller' >&2; exit 1");
    CHECK_THROWS_AS(slurm_config(), TryAgain);
    slurm.program("scontrol", "echo 'fatal: Could not establish a configuration source' >&2; exit 1");
    CHECK_THROWS_AS(slurm_config(), FileError);
}

TEST_CASE("The queue is this user's, and others' jobs are not asked for") {
    const StandIns slurm;
    slurm.program("squeue", "echo \"$@\" >$AT/asked; echo 17; echo 17; echo ' 18 '");
    CHECK(slurm_queue().numbers == std::set<std::string>{"17", "18"});
    CHECK_THAT(slurm.text("asked"), Contains("--me"));
}

TEST_CASE("What is held in the queue is told from what waits, with Slurm's reason") {
    const StandIns slurm;
    slurm.program(
        "squeue",
        "echo '17 PD JobHeldAdmin'; echo '18 SE JobHeldUser'; echo '19 PD Resources'; echo '20 R None'\n"
        "echo '21 PD launch_failed_requeued_held'; echo '22 SE None'; echo '23 PD (ReqNodeNotAvail, Held on)'\n"
        "echo '24 PD BeginTime'; echo");
    const SlurmQueue queue = slurm_queue();
    CHECK(queue.numbers.size() == 8);
    CHECK(queue.held ==
          std::map<std::string, std::string>{
              {"17", "JobHeldAdmin"}, {"18", "JobHeldUser"}, {"21", "launch_failed_requeued_held"}, {"22", ""}});
}

TEST_CASE("Slurm's word for a job that took too much memory is heard, where it still knows the job") {
    const StandIns slurm;
    slurm.program("scontrol", "echo \"$@\" >$AT/asked; echo 'JobId=17 JobState=OUT_OF_MEMORY Reason=OutOfMemory'");
    CHECK(ended_out_of_memory("17"));
    CHECK_THAT(slurm.text("asked"), Contains("show job 17"));
    slurm.program("scontrol", "echo 'JobId=17 JobState=FAILED Reason=JobLaunchFailure'");
    CHECK_FALSE(ended_out_of_memory("17"));
    slurm.program("scontrol", "echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1");
    CHECK_FALSE(ended_out_of_memory("17"));
}

TEST_CASE("sbatch's answer is a number, or says why there is none") {
    const StandIns slurm;
    CHECK(submit(slurm, "echo 4711") == "4711");
    CHECK(submit(slurm, "echo '4711;cluster'") == "4711");
    CHECK_THROWS_AS(submit(slurm, "echo Submitted"), InputError);
    CHECK_THROWS_AS(submit(slurm, "exit 0"), InputError);
    CHECK_THROWS_WITH(submit(slurm, "echo 'sbatch: error: invalid partition' >&2; exit 1"),
                      Contains("refuses") && Contains("invalid partition"));
    for (const char* later : {"Socket timed out on send/recv operation", "Slurm temporarily unable to accept job",
                              "Job violates accounting/QOS policy (job submit limit, user's size)"}) {
        INFO(later);
        CHECK_THROWS_AS(submit(slurm, std::string("echo \"") + later + "\" >&2; exit 1"), TryAgain);
    }
}

TEST_CASE("What cannot be started is told as what it is") {
    const StandIns slurm;
    CHECK(run_command(Words{"voxtone-no-such-program"}).exit_code == CommandOutput::no_such_program);
    {
        const Variable path("PATH", slurm.at("nothing").string());
        CHECK_THROWS_WITH(slurm_config(), Contains("scontrol is not on this machine") && Contains("--dry-run"));
    }
    // One word of more than Linux takes (MAX_ARG_STRLEN, 128 KiB).
    slurm.program("sbatch", "echo 1");
    try {
        (void)submit_to_slurm(Words{"--dependency=afterany:" + std::string(200'000, '1')});
        FAIL("it was started");
    } catch (const ResourceError& error) {
        CHECK_THAT(error.what(),
                   Contains("longer than this system takes") && Contains("200022") && !Contains("not on this machine"));
    }
    // There, and no program: for root, too.
    fs::permissions(slurm.at("sbatch"), fs::perms::owner_read);
    CHECK_THROWS_WITH(run_command(Words{slurm.at("sbatch").string()}), Contains("is here and cannot be run"));
}

TEST_CASE("Any number of jobs is cancelled, in words that a command takes") {
    const StandIns slurm;
    slurm.program("scancel", "echo $# >>$AT/counts");
    cancel_in_slurm({});
    CHECK_FALSE(fs::exists(slurm.at("counts")));
    cancel_in_slurm(Words(2500, "1234567"));
    CHECK(slurm.text("counts") == "1001\n1001\n501\n");
}

TEST_CASE("What a task has of its time is read as squeue writes it") {
    const StandIns slurm;
    const auto time_of = [&](const std::string& said) {
        slurm.program("squeue", "echo '" + said + "'");
        const auto time = slurm_time("17_3");
        return time ? std::pair(time->left_s, time->limit_s) : std::pair(-1.0, -1.0);
    };
    CHECK(time_of("0:58 22:00") == std::pair(58.0, 1320.0));
    CHECK(time_of("2:00:01 1-02:03:04") == std::pair(7201.0, 93784.0));
    for (const char* none : {"UNLIMITED UNLIMITED", "INVALID 22:00", "0:58", "", "58 22"})
        CHECK(time_of(none).first == -1);
    slurm.program("squeue", "echo '0:58 22:00'; exit 1");
    CHECK_FALSE(slurm_time("17"));
}

TEST_CASE("A task is taken out where Slurm ends it before its time is over") {
    const StandIns slurm;
    const auto is_taken_out = [&](const std::string& said) {
        slurm.program("squeue", "echo \"$@\" >$AT/asked; echo '" + said + "'");
        return is_taken_out_of_slurm("17_3");
    };
    CHECK(is_taken_out("CG 15:00"));
    CHECK(is_taken_out("CG UNLIMITED"));
    CHECK(slurm.text("asked") == "--noheader --format=%t %L --jobs=17_3\n");
    for (const char* other : {"CG 0:00", "R 15:00", "PD 15:00", ""}) CHECK_FALSE(is_taken_out(other));
    slurm.program("squeue", "echo 'CG 15:00'; exit 1");
    CHECK_FALSE(is_taken_out_of_slurm("17"));
}

TEST_CASE("An allocation is that of a job, or of one task of an array") {
    {
        const SlurmEnvironment none({}, {}, {});
        CHECK(own_slurm_allocation().number.empty());
        CHECK(own_slurm_allocation().task.empty());
    }
    {
        const SlurmEnvironment job("17", {}, {}, "3");
        CHECK(own_slurm_allocation().number == "17");
        CHECK(own_slurm_allocation().task == "17");
        CHECK(own_slurm_allocation().restarts == 3);
    }
    const SlurmEnvironment task("20", "17", "3");
    CHECK(own_slurm_allocation().number == "17");
    CHECK(own_slurm_allocation().task == "17_3");
    CHECK(own_slurm_allocation().restarts == 0);
}
