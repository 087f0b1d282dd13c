// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "base/error.h"
#include "base/progress_events.h"
#include "cli/batch/batch_commands.h"
#include "cli/batch/cluster_options.h"
#include "cli/program/common_options.h"
#include "farm/cluster/cluster_task.h"
#include "slicer/options/option_values.h"

namespace voxtone::cli {

namespace {

struct TaskArguments {
    std::string out, job, stage, shard;
    int retries = 5, threads = 0;
    bool last = false;
    ConsoleOptions console;
};

int run(const TaskArguments& arguments) {
    if (arguments.last != (arguments.job.empty() && arguments.stage.empty() && arguments.shard.empty()))
        throw UsageError("name a job and its stage (--job, --stage), or --last alone");
    farm::TaskOptions options;
    options.out = arguments.out;
    options.program = this_program();
    options.job = arguments.job;
    options.retries = arguments.retries;
    options.threads = arguments.threads;
    if (arguments.console.openjd()) options.relay = stdout_sink();
    if (!arguments.last) {
        const auto stage = value_of<farm::TaskStage>(arguments.stage);
        if (!stage)
            throw UsageError(fmt::format("--stage: '{}' is none of whole, prepare, layers, merge", arguments.stage));
        options.stage = *stage;
        options.shard = slicer::parse_shard(arguments.shard);
    }
    return run_on_console(arguments.console, [&](Progress& progress) {
        return arguments.last ? farm::close_cluster_batch(arguments.out, progress)
                              : farm::run_cluster_task(options, progress);
    });
}

}  // namespace

Verb task_verb() {
    auto arguments = std::make_shared<TaskArguments>();
    Verb command("task",
                 "Do one task of a batch that was handed to a cluster: what the scripts "
                 "of `batch --slurm` and the templates of `--openjd` call",
                 "out/monday --job cow --stage layers --shard 3/16");
    command.add("batch", arguments->out, "folder of the batch", {.unit = "FOLDER", .required = true});
    command.add("--job", arguments->job, "job of the batch; required, unless --last", {.unit = "NAME"});
    command.add("--stage", arguments->stage,
                "whole, prepare (the appearance loop), layers (a shard) or merge; required, unless --last",
                {.unit = "STAGE"});
    command.add("--shard", arguments->shard, "which shard of how many, of the stage layers; default: none",
                {.unit = "I/N"});
    command.add(
        "--retries", arguments->retries,
        "how often it is put back into Slurm's queue when it failed for no fault of its own (exit codes 75, 85)",
        {.range = {0, 1000}});
    command.add("--threads", arguments->threads,
                "threads of the work, where the job does not say; 0: one per core that it was given",
                {.range = {0, 4096}});
    command.add("--last", arguments->last,
                "when all tasks have ended: note what became of the jobs, and draw the summary");
    add_console_options(command, arguments->console);
    arguments->console.grace = std::chrono::seconds(50);  // the work saves itself first
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
