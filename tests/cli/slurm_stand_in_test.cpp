// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `voxtone batch --slurm` asks of Slurm, and what it makes of the answers: told by stand-ins for its commands.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;

/// Two models, and a folder of programs that PATH leads to and nothing else but the shell's own.
struct Workshop {
    Workshop() : folder("stand-in") {
        for (int i = 1; i <= 2; ++i) folder.write(fmt::format("box{}.obj", i), soft_box_obj(3 + i, 2, 2));
        folder.write("plan.jsonl", "{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\"}\n");
        folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "iterations": 0, "report": false})");
        fs::create_directory(folder.path() / "bin");
        old_path = std::getenv("PATH");
        setenv("PATH", ((folder / "bin") + ":/usr/bin:/bin").c_str(), 1);
    }
    ~Workshop() { setenv("PATH", old_path.c_str(), 1); }
    Workshop(const Workshop&) = delete;
    Workshop& operator=(const Workshop&) = delete;

    void program(const std::string& name, const std::string& text) const {
        folder.write("bin/" + name, "#!/bin/sh\n" + text);
        fs::permissions(folder.path() / "bin" / name, fs::perms::owner_all);
    }
    /// sbatch notes its words and says 1, 2, 3, ...; what it has said waits in the queue.
    void slurm(const std::string& max_array_size = "1001") const {
        program("scontrol", "echo 'MaxArraySize            = " + max_array_size + "'\n");
        program("squeue", "cat " + (folder / "queue") + " 2>/dev/null || true\n");
        program("scancel", "echo scancel \"$@\" >>" + (folder / "said") + "\n");
        program("sbatch", fmt::format("echo sbatch \"$@\" >>{0}\nn=$(($(cat {1} 2>/dev/null | wc -l) + 1))\n"
                                      "echo $n >>{1}\necho \"$n;cluster\"\n",
                                      folder / "said", folder / "queue"));
    }
    [[nodiscard]] Outcome batch(const std::string& options) const {
        return run_program(fmt::format("batch {} --preset {} -o {} --slurm --threads 1 {}", folder / "plan.jsonl",
                                       folder / "quick.json", folder / "out", options));
    }
    /// Calls of sbatch and scancel, one a line.
    [[nodiscard]] std::vector<std::string> calls() const {
        std::istringstream in(read_file(folder.path() / "said"));
        std::vector<std::string> lines;
        for (std::string line; std::getline(in, line);) lines.push_back(line);
        return lines;
    }
    [[nodiscard]] nlohmann::json state(const std::string& name) const {
        return nlohmann::json::parse(read_file(folder.path() / "out/batch" / (name + ".json")));
    }

    Folder folder;
    std::string old_path;
};

std::size_t lines_of(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string last_line(const std::string& text) {
    std::istringstream in(text);
    std::string last;
    for (std::string line; std::getline(in, line);) last = line;
    return last;
}

}  // namespace

TEST_CASE("Without Slurm nothing is submitted, in one sentence, a dry run prints the scripts") {
    const Workshop shop;
    setenv("PATH", (shop.folder / "bin").c_str(), 1);
    const Outcome none = shop.batch("--quiet");
    CHECK(none.exit_code == 4);
    CHECK(lines_of(none.err) == 1);
    CHECK_THAT(none.err, Contains("scontrol is not on this machine") && Contains("--dry-run"));
    CHECK_FALSE(fs::exists(shop.folder.path() / "out"));

    const Outcome dry = shop.batch("--dry-run --shards 3 --sbatch-option partition=long --sbatch-option account=lab");
    INFO(dry.err);
    CHECK(dry.exit_code == 0);
    CHECK_FALSE(fs::exists(shop.folder.path() / "out"));
    CHECK_THAT(dry.err, Contains("1000 tasks"));
    CHECK_THAT(dry.out, Contains("--array=1-3 --partition=long --account=lab " +
                                 (shop.folder / "out/batch/slurm/box1/layers.sh")));
    CHECK_THAT(dry.out, Contains("--dependency=afterok:NUMBER-OF-box1-layers"));
    CHECK_THAT(dry.out, Contains("#SBATCH --cpus-per-task=1") && Contains("slurm-last.sh"));
    CHECK_THAT(dry.out, Contains("2 jobs, 2 left"));
    const std::string events = shop.batch("--dry-run --quiet --json").out;
    const auto told = nlohmann::json::parse(last_line(events));
    CHECK_THAT(told.dump(), Contains("\"dry_run\":true") && Contains("#SBATCH --mem="));
}

TEST_CASE("A Slurm that does not answer is to be asked again later") {
    const Workshop shop;
    shop.slurm();
    shop.program("scontrol", "echo 'slurm_load_ctl_conf error: Unable to contact slurm controller' >&2; exit 1\n");
    const Outcome silent = shop.batch("--quiet");
    CHECK(silent.exit_code == 75);
    CHECK(lines_of(silent.err) == 1);
    CHECK_THAT(silent.err, Contains("Unable to contact slurm controller") && Contains("nothing is submitted"));
    CHECK(shop.calls().empty());
}

TEST_CASE("What Slurm ended for memory is handed over again with twice as much, and what it holds back is named") {
    const Workshop shop;
    shop.slurm();
    REQUIRE(shop.batch("--quiet").exit_code == 0);
    const std::string script = "out/batch/slurm/box1/whole.sh";
    const auto given_mib = [&] {
        const std::string text = read_file(shop.folder.path() / script), option = "#SBATCH --mem=";
        return std::stol(text.substr(text.find(option) + option.size()));
    };
    const long first = given_mib();
    // By OverMemoryKill, which leaves nobody to say so.
    shop.folder.write("out/batch/slurm/box1/whole.1.out",
                      "slurmstepd: error: StepId=1.batch exceeded memory limit (99999 > 4096), being killed\n");
    fs::remove(shop.folder.path() / "queue");
    REQUIRE(run_program("task " + (shop.folder / "out") + " --last").exit_code == 0);
    CHECK_THAT(shop.state("box1")["message"].get<std::string>(), Contains("Slurm ended it for memory"));
    CHECK(shop.state("box1")["exit_code"] == 5);
    CHECK(shop.state("box2")["exit_code"] == 75);
    CHECK_THAT(run_program("status " + (shop.folder / "out")).out, Contains("ended it for memory"));
    const Outcome again = shop.batch("");
    CHECK_THAT(again.out, Contains("box1: submitted") && Contains("whole is given"));
    CHECK(std::abs(given_mib() - 2 * first) <= 1);

    shop.program("squeue", "echo '1 PD JobHeldAdmin'; echo '2 PD Resources'\n");
    const Outcome held = shop.batch("");
    CHECK_THAT(held.out, Contains("box1: queued") && Contains("JobHeldAdmin") && Contains("`scontrol release 1`"));
    CHECK_THAT(run_program("status " + (shop.folder / "out")).out,
               Contains("JobHeldAdmin") && Contains("`scontrol release 1`") && !Contains("release 2"));
}

TEST_CASE("Chains are submitted with arrays that Slurm takes, within the throttle, and not twice") {
    const Workshop shop;
    shop.slurm("3");
    const Outcome first = shop.batch("--shards 5 --throttle 5 --json --quiet");
    INFO(first.err);
    REQUIRE(first.exit_code == 0);
    const auto calls = shop.calls();
    REQUIRE(calls.size() == 9);
    const std::string at = shop.folder / "out/batch", chdir = "sbatch --parsable --chdir=" + at + " ";
    const std::string array = "--output=slurm/box1/layers.%A_%a.out --array=1-";
    CHECK(calls[0] == chdir + array + "2 " + at + "/slurm/box1/layers.sh");
    CHECK(calls[1] == chdir + array + "2 --dependency=afterany:1 " + at + "/slurm/box1/layers.sh 2");
    CHECK(calls[2] == chdir + array + "1 --dependency=afterany:2 " + at + "/slurm/box1/layers.sh 4");
    CHECK(calls[3] ==
          chdir + "--output=slurm/box1/merge.%j.out --dependency=afterok:1:2:3 " + at + "/slurm/box1/merge.sh");
    CHECK_THAT(calls[4], Contains(" --array=1-2 --dependency=afterany:1:2:3:4 " + at + "/slurm/box2/layers.sh"));
    CHECK(calls[8] ==
          chdir + "--output=slurm/last.%j.out --dependency=afterany:1:2:3:4:5:6:7:8 " + at + "/slurm-last.sh");
    const auto told = nlohmann::json::parse(last_line(first.out));
    CHECK_THAT(told.dump(), Contains("\"numbers\":[\"1\",\"2\",\"3\"]") && Contains("\"last\":\"9\""));
    CHECK(shop.state("box1")["message"] == "submitted: in Slurm (layers 1 2 3, merge 4)");

    CHECK_THAT(shop.batch("--shards 5").out, Contains("2 jobs, 2 queued"));
    CHECK(shop.calls().size() == 9);
    // Slurm knows nothing of them any more, and they are not done: again.
    fs::remove(shop.folder.path() / "queue");
    CHECK_THAT(shop.batch("--shards 1").out, Contains("2 jobs, 2 submitted"));
    CHECK(shop.calls().size() == 9 + 2 + 1);
}

TEST_CASE("Where sbatch refuses, what was submitted before is noted, and nothing of the refused job is left") {
    const Workshop shop;
    shop.slurm();
    const std::string sbatch = read_file(shop.folder.path() / "bin/sbatch");
    shop.folder.write("bin/sbatch",
                      "#!/bin/sh\ncase \"$*\" in *box2/merge*) echo 'sbatch: error: invalid partition "
                      "specified: long' >&2; exit 1;; esac\n" +
                          sbatch);
    const Outcome refused = shop.batch("--shards 2 --quiet");
    CHECK(refused.exit_code == 3);
    CHECK(lines_of(refused.err) == 1);
    CHECK_THAT(refused.err, Contains("box2: sbatch refuses it: sbatch: error: invalid partition specified: long") &&
                                Contains("1 of 2 jobs were submitted before and stay"));
    const auto calls = shop.calls();
    REQUIRE(calls.size() == 5);
    CHECK(calls[3] == "scancel --quiet 3");
    CHECK_THAT(calls[4], Contains("--dependency=afterany:2 ") && Contains("slurm-last.sh"));
    CHECK(shop.state("box1")["message"] == "submitted: in Slurm (layers 1, merge 2)");
    CHECK_THAT(shop.state("box2")["message"].get<std::string>(), Contains("was not submitted: "));

    shop.folder.write("bin/sbatch", sbatch);
    CHECK_THAT(shop.batch("--shards 2").out, Contains("1 submitted, 1 queued"));

    fs::remove(shop.folder.path() / "queue");
    shop.program("sbatch",
                 "echo 'sbatch: error: Batch job submission failed: Socket timed out on send/recv' >&2\nexit 1\n");
    CHECK(shop.batch("--shards 2 --quiet").exit_code == 75);
}

TEST_CASE("A refused task that waits for all is submitted by the next call, and not twice") {
    const Workshop shop;
    shop.slurm();
    const std::string sbatch = read_file(shop.folder.path() / "bin/sbatch");
    shop.folder.write("bin/sbatch",
                      "#!/bin/sh\ncase \"$*\" in *slurm-last*) echo 'sbatch: error: QOSMaxSubmitJobPerUser"
                      "Limit: job submit limit' >&2; exit 1;; esac\n" +
                          sbatch);
    const Outcome refused = shop.batch("--quiet");
    CHECK(refused.exit_code == 75);
    CHECK(lines_of(refused.err) == 1);
    CHECK_THAT(refused.err, Contains("2 jobs were submitted, but not the task that is to tell") &&
                                Contains("job submit limit") && Contains("run the same command again"));
    CHECK(shop.calls().size() == 2);
    CHECK(shop.state("box2")["message"] == "submitted: in Slurm (whole 2)");
    CHECK(fs::exists(shop.folder.path() / "out/index.html"));

    shop.folder.write("bin/sbatch", sbatch);
    CHECK_THAT(shop.batch("").out, Contains("2 jobs, 2 queued") && Contains("when all has ended, job 3 says"));
    REQUIRE(shop.calls().size() == 3);
    CHECK_THAT(shop.calls()[2], Contains("--dependency=afterany:1:2 ") && Contains("slurm-last.sh"));
    CHECK_THAT(shop.batch("").out, Contains("2 jobs, 2 queued"));
    CHECK(shop.calls().size() == 3);
    // It was cancelled, and the jobs are still in the queue.
    shop.folder.write("queue", "1\n2\n");
    CHECK_THAT(shop.batch("").out, Contains("2 jobs, 2 queued") && Contains("when all has ended"));
    CHECK(shop.calls().size() == 4);
    // What is submitted later is waited for by another one, with what is there still.
    shop.folder.write("box3.obj", soft_box_obj(2, 2, 2));
    shop.folder.write("plan.jsonl",
                      "{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\"}\n{\"model\": \"box3.obj\"}\n");
    CHECK_THAT(shop.batch("").out, Contains("3 jobs, 1 submitted, 2 queued"));
    REQUIRE(shop.calls().size() == 6);
    CHECK_THAT(shop.calls()[5], Contains("--dependency=afterany:1:2:4 ") && Contains("slurm-last.sh"));
}

TEST_CASE("A model whose name is no UTF-8 goes through plan, submission and tasks whole") {
    const Workshop shop;
    shop.slurm();
    fs::rename(shop.folder.path() / "box1.obj", shop.folder.path() / "caf\xE9.obj");
    fs::create_directory(shop.folder.path() / "models");
    for (const char* name : {"caf\xE9.obj", "box2.obj"})
        fs::rename(shop.folder.path() / name, shop.folder.path() / "models" / name);
    const std::string common = fmt::format("--preset {} -o {}", shop.folder / "quick.json", shop.folder / "out");
    const Outcome submitted =
        run_program(fmt::format("batch {} {} --slurm --threads 1 --shards 2", shop.folder / "models", common));
    INFO(submitted.err);
    REQUIRE(submitted.exit_code == 0);
    const std::string task = fmt::format("task {} --quiet --job 'caf%E9' --stage ", shop.folder / "out");
    for (const char* stage : {"layers --shard 1/2", "layers --shard 2/2", "merge"}) {
        const Outcome done = run_program(task + stage);
        INFO(done.err);
        CHECK(done.exit_code == 0);
    }
    CHECK(shop.state("caf%E9")["state"] == "done");
    // Its job file, too, names it for a local batch, which finds it done.
    const Outcome local = run_program(fmt::format("batch {} {}", shop.folder / "models", common));
    INFO(local.err);
    CHECK(local.exit_code == 0);
    CHECK_THAT(local.out, Contains("2 of 2 jobs done (1 before, and unchanged)"));
}

TEST_CASE("A job that cannot be estimated is told and stands as failed, and the others are submitted") {
    const Workshop shop;
    shop.slurm();
    shop.folder.write("box1.obj", "v 0 0 0\nf 1 2 3\n");
    const Outcome outcome = shop.batch("");
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.out, Contains("2 jobs, 1 submitted, 1 failed") && Contains("box1: failed: "));
    CHECK(shop.state("box1")["state"] == "failed");
    CHECK(shop.state("box2")["state"] == "queued");
    CHECK(shop.calls().size() == 2);
}

TEST_CASE("Options that do not go with a cluster, or only with it, are refused") {
    const Workshop shop;
    shop.slurm();
    for (const char* options : {"--jobs 2", "--memory 2", "--fail-fast", "--after true", "--print-commands"})
        CHECK(shop.batch(options).exit_code == 2);
    const std::string local = fmt::format("batch {} -o {} ", shop.folder / "plan.jsonl", shop.folder / "out");
    for (const char* options : {"--dry-run", "--shards 2", "--throttle 2", "--sbatch-option x=y"})
        CHECK_THAT(run_program(local + options).err, Contains("goes with --slurm"));
    CHECK(run_program(fmt::format("batch --watch {0} -o {1} --slurm", shop.folder.path().string(), shop.folder / "out"))
              .exit_code == 2);
    CHECK_FALSE(fs::exists(shop.folder.path() / "out"));
}

TEST_CASE("An option of sbatch that would undo the order or the place of the tasks is refused") {
    const Workshop shop;
    shop.slurm();
    for (const char* word : {"dependency=singleton", "--depend=afterok:1", "-dafterok:1", "array=1-2", "chdir=/tmp",
                             "output=x", "wrap=true", "test-only", "wait"}) {
        const Outcome outcome = shop.batch(fmt::format("--sbatch-option={}", word));
        INFO(word << ": " << outcome.err);
        CHECK(outcome.exit_code == 2);
        CHECK_THAT(outcome.err, Contains("--sbatch-option") && Contains("is said by voxtone itself"));
    }
    for (const char* word : {"clusters=far", "--clusters=far", "-Mfar"})
        CHECK_THAT(shop.batch(fmt::format("--sbatch-option={}", word)).err,
                   Contains("another cluster") && Contains("call voxtone there"));
    CHECK_FALSE(fs::exists(shop.folder.path() / "out"));
    for (const char* word : {"cluster-constraint=fast", "wait-all-nodes=1", "-plong", "mem=2G"})
        CHECK(shop.batch(fmt::format("--dry-run --sbatch-option={}", word)).exit_code == 0);
}

TEST_CASE("A task that was never handed over, or was handed over anew since, is refused") {
    const Workshop shop;
    shop.slurm();
    REQUIRE(shop.batch("--shards 2").exit_code == 0);
    const std::string out = shop.folder / "out";
    const auto fault = [&](const std::string& words, int exit_code) {
        const Outcome outcome = run_program(fmt::format("task {} --quiet {}", out, words));
        CHECK(outcome.exit_code == exit_code);
        return outcome.err;
    };
    CHECK_THAT(fault("--job nobody --stage merge", 4), Contains("nobody"));
    CHECK_THAT(fault("--job box1 --stage prepare", 3), Contains("without a stage prepare"));
    CHECK_THAT(fault("--job box1 --stage layers --shard 1/3", 3), Contains("has 2 shards, and not 3"));
    CHECK_THAT(fault("--job box1 --stage layers", 2), Contains("--shard"));
    CHECK_THAT(fault("--job box1 --stage merge --shard 1/2", 2), Contains("--shard"));
    CHECK_THAT(fault("--job box1 --stage all", 2), Contains("whole, prepare, layers, merge"));
    CHECK_THAT(fault("--job box1 --last", 2), Contains("--last alone"));
    CHECK_THAT(fault("", 2), Contains("--job"));

    // Without Slurm's environment they are tasks like any others.
    for (const char* words :
         {"--job box1 --stage layers --shard 2/2", "--job box1 --stage layers --shard 1/2", "--job box1 --stage merge"})
        CHECK(run_program(fmt::format("task {} {}", out, words)).exit_code == 0);
    CHECK(shop.state("box1")["state"] == "done");
    fs::remove(shop.folder.path() / "queue");
    CHECK(run_program(fmt::format("task {} --last", out)).exit_code == 0);
    CHECK(shop.state("box2")["state"] == "failed");
    CHECK(shop.state("box2")["exit_code"] == 75);
    CHECK_THAT(shop.state("box2")["message"].get<std::string>(), Contains("layers 3, merge 4"));
}

TEST_CASE("Tasks of a job that is planned otherwise now replace what the batch has made, at once and in any order") {
    const Workshop shop;
    shop.slurm();
    shop.folder.write("plan.jsonl", "{\"model\": \"box1.obj\"}\n");
    const auto do_all = [&] {
        REQUIRE(shop.batch("--shards 3").exit_code == 0);
        fs::remove(shop.folder.path() / "queue");
        const std::string task = fmt::format("{} task {} --quiet --job box1 --stage ", program(), shop.folder / "out");
        REQUIRE(
            run_shell(fmt::format("for i in 3 1 2 2; do {0} layers --shard $i/3 >/dev/null & pids=\"$pids $!\"; done; "
                                  "for p in $pids; do wait $p || exit 1; done; {0} merge >/dev/null",
                                  task)) == 0);
        CHECK(shop.state("box1")["state"] == "done");
    };
    do_all();
    const auto first = read_tree(shop.folder.path() / "out/box1/layers");
    shop.folder.write("quick.json",
                      R"({"format": "voxtone-job", "version": 1, "iterations": 0, "report": false, "flip-x": true})");
    do_all();
    const auto second = read_tree(shop.folder.path() / "out/box1/layers");
    CHECK(second != first);
    REQUIRE(run_program(fmt::format("slice {} --job {} -o {}", shop.folder / "box1.obj", shop.folder / "quick.json",
                                    shop.folder / "alone"))
                .exit_code == 0);
    CHECK(second == read_tree(shop.folder.path() / "alone/layers"));
    CHECK(run_program(fmt::format("verify {}", shop.folder / "out/box1")).exit_code == 0);
    // What the batch has not made it does not replace.
    fs::remove_all(shop.folder.path() / "out/box1");
    fs::remove(shop.folder.path() / "out/batch/box1.json");
    fs::copy(shop.folder.path() / "alone", shop.folder.path() / "out/box1", fs::copy_options::recursive);
    shop.folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "iterations": 0, "report": false})");
    REQUIRE(shop.batch("--shards 3").exit_code == 0);
    CHECK(run_program(fmt::format("task {} --quiet --job box1 --stage layers --shard 1/3", shop.folder / "out"))
              .exit_code == 3);
    CHECK(read_tree(shop.folder.path() / "out/box1/layers") == second);
    CHECK(shop.state("box1")["state"] == "failed");
    CHECK_THAT(shop.state("box1")["message"].get<std::string>(),
               Contains("shard 1 of 3: ") && Contains("holds a stack"));
}

TEST_CASE("The tasks of a tray in shards make what one go makes") {
    const Workshop shop;
    shop.slurm();
    shop.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "box1.obj", "copies": 3}, {"model": "box2.obj"}]})");
    shop.folder.write("plan.jsonl", "{\"model\": \"tray.json\"}\n");
    const Outcome submitted = shop.batch("--shards 2");
    CAPTURE(submitted.err);
    REQUIRE(submitted.exit_code == 0);
    for (const char* words : {"--job tray --stage layers --shard 2/2", "--job tray --stage layers --shard 1/2",
                              "--job tray --stage merge"}) {
        const Outcome task = run_program(fmt::format("task {} {}", shop.folder / "out", words));
        CAPTURE(task.err);
        CHECK(task.exit_code == 0);
    }
    CHECK(shop.state("tray")["state"] == "done");
    REQUIRE(run_program(fmt::format("slice {} --job {} -o {}", shop.folder / "tray.json", shop.folder / "quick.json",
                                    shop.folder / "alone"))
                .exit_code == 0);
    CHECK(read_tree(shop.folder.path() / "out/tray/layers") == read_tree(shop.folder.path() / "alone/layers"));
}
