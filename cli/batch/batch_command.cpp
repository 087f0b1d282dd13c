// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "cli/batch/batch_commands.h"
#include "cli/batch/batch_view.h"
#include "cli/batch/cluster_options.h"
#include "cli/program/common_options.h"
#include "farm/batch/batch_job.h"

namespace voxtone::cli {

namespace {

struct BatchArguments {
    farm::PlanOptions plan;
    farm::BatchOptions batch;
    std::string out;
    double memory_gib = 0;
    bool print_commands = false;
    std::string watch;
    bool only_tell = false;
    ClusterOptions cluster;
    RunOptions run;
};

void add_plan_options(Verb& command, BatchArguments& arguments) {
    command.add(
        "plan", arguments.plan.plan,
        "job list (.jsonl: one job a line, with the keys of job files), table (.csv, .tsv with a header of such "
        "keys), folder of models, or models and patterns of them; a key \"name\" names a job",
        {.unit = "PLAN"});
    add_out_option(command, arguments.out, "FOLDER",
                   "folder of the batch: job NAME goes to FOLDER/NAME; nothing is written outside it");
    command.add("--preset", arguments.plan.preset, "job file whose options all jobs begin with; empty: none",
                {.unit = "FILE"});
    command.add("--name", arguments.plan.name,
                "names of the jobs: {name} is that of the plan or of the model, {n:03} counts them, {size} or another "
                "key of an option is its value",
                {.unit = "TEMPLATE"});
}

void add_batch_options(Verb& command, BatchArguments& arguments) {
    command.add("--jobs", arguments.batch.jobs, "most jobs at once; 0: as many as cores (--threads) and memory allow",
                {.range = {0, 1024}});
    command.add("--memory", memory(arguments.memory_gib), "memory for all jobs together, GiB; 0: the machine's",
                {.range = {0.0, 1e6}});
    command.add("--retries", arguments.batch.retries,
                "how often a job is tried again that failed for no fault of its own (exit code 75, stopped, killed), "
                "after 2, 4, 8, ... s",
                {.range = {0, 1000}});
    command.add("--fail-fast", arguments.batch.fail_fast,
                "stop at the first job that fails; others are saved and go on when the batch is run again");
    command.add("--after", arguments.batch.after,
                "command for the shell, run once for each result when it is whole, with the state of the job "
                "(JSON) on stdin; empty: none",
                {.unit = "CMD"});
    command.add("--watch", arguments.watch,
                "in the place of a plan: slice the models in this folder and those that arrive there, once they "
                "have not changed for 3 s, until it is stopped; empty: do not",
                {.unit = "FOLDER"});
    command.add(
        "--wait-for-files", time(arguments.batch.wait_s),
        "with --watch: how long, s, a model waits for files that it names (material library, textures, buffers) "
        "and that are not there yet, before it is sliced without; what comes later has it sliced again",
        {.range = {0.0, 1e6}});
    command.add("--only-tell", arguments.only_tell,
                "with --watch: tell of models that are complete, with --json as events \"arrived\" with the files "
                "beside them, and slice none: for a program with a queue of its own");
    command.add("--print-commands", arguments.print_commands,
                "print the command of each job, quoted for a shell, and stop");
}

int run(const Verb::Said& said, const BatchArguments& arguments) {
    farm::PlanOptions plan = arguments.plan;
    if (std::filesystem::path(arguments.out).extension() == ".gcvf")
        throw UsageError(
            fmt::format("--out {}: a batch has a folder, with one of each job in it; name that, and give "
                        "the jobs gcvf among their --formats",
                        arguments.out));
    if (arguments.cluster.any() && !arguments.watch.empty())
        throw UsageError(fmt::format("{} is for a plan; what will arrive in a folder is not known",
                                     arguments.cluster.slurm ? "--slurm" : "--openjd"));
    farm::BatchOptions batch = arguments.batch;
    plan.out = batch.out = arguments.out;
    batch.program = this_program();
    expect_cluster_options(said, arguments.cluster);
    batch.cores = arguments.run.threads;
    batch.memory_bytes = static_cast<std::uint64_t>(arguments.memory_gib * (1 << 30));
    const RunOptions& options = arguments.run;
    if (plan.plan.empty() == arguments.watch.empty())
        throw UsageError(plan.plan.empty()
                             ? "name a plan: a job list, a table, a folder of models or models; or a folder to --watch"
                             : "--watch takes the place of a plan; give one of them");
    if (!arguments.watch.empty() && arguments.print_commands)
        throw UsageError("--print-commands is for a plan; what will arrive in a folder is not known");
    if (arguments.only_tell && arguments.watch.empty()) throw UsageError("--only-tell is for --watch");
    if (arguments.cluster.any()) return run_on_cluster(plan, batch, arguments.cluster, arguments.run);
    if (arguments.print_commands)
        return run_on_console(
            options, [&](Progress& progress) { return farm::print_batch_commands(plan, batch.program, progress); });
    const std::unique_ptr<farm::BatchView> view = make_batch_view(options.console);
    return run_on_console(options, [&](Progress& progress) -> JobResult {
        if (arguments.only_tell) farm::run_arrivals_job(arguments.watch, plan, batch, *view, progress);
        if (!arguments.watch.empty()) farm::run_watch_job(arguments.watch, plan, batch, *view, progress);
        return farm::run_batch_job(plan, batch, *view, progress);
    });
}

}  // namespace

Verb batch_verb() {
    auto arguments = std::make_shared<BatchArguments>();
    Verb command("batch",
                 "Slice many models, as many at once as the machine allows; run it again to go on where it ended",
                 "plan.csv -o out/monday");
    add_plan_options(command, *arguments);
    add_batch_options(command, *arguments);
    add_cluster_options(command, arguments->cluster);
    add_run_options(command, arguments->run);
    arguments->run.console.grace = std::chrono::seconds(28);  // jobs save themselves first
    command.run = [arguments, said = command.said] { return run(*said, *arguments); };
    return command;
}

}  // namespace voxtone::cli
