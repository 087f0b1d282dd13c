// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "io/shards/shard_number.h"
#include "slicer/print/run_print.h"

namespace voxtone::cli {

namespace {

struct MergeArguments {
    std::string out, for_printer;
    slicer::MergeOptions options;
    RunOptions run;
};

int run(MergeArguments& arguments) {
    arguments.options.out = arguments.out;
    arguments.options.for_printer = arguments.for_printer;
    arguments.options.threads = arguments.run.threads;
    return run_on_console(arguments.run,
                          [&](Progress& progress) { return slicer::run_merge(arguments.options, progress); });
}

}  // namespace

Verb merge_verb() {
    auto arguments = std::make_shared<MergeArguments>();
    slicer::MergeOptions& options = arguments->options;
    Verb command(
        "merge",
        "Lay the shards of a job (slice --shard) together to one stack, the same bits as without shards, and write its "
        "report; no layer is read again. Missing shards are named as a scheduler takes them; once merged, it says so",
        "out/cow");
    command.add("out", arguments->out, "output folder of the shards", {.unit = "FOLDER", .required = true});
    command.add("--overwrite", options.overwrite,
                "replace another job's stack that the folder holds; other things in it stay");
    command.add("--report", options.report, "write the report as the job asked for it, which reads the model again",
                {.off = true});
    command.add("--predict", options.predict,
                "predict the print for the report, as the job asked for it; makes its layers once more, in memory",
                {.off = true});
    command.add("--for-printer", arguments->for_printer,
                "put what the printer's computer takes, and how to print it, here too: a folder, one ZIP file, or "
                "the GCVF file alone; OUT/printer has it in any case",
                {.unit = "FOLDER|FILE.zip|FILE.gcvf"});
    command.add(
        "--shards", options.shards,
        "how many shards there are known to be, all made: one that is not seen yet, as on a network file system, "
        "is waited for, for a minute; 0: those that lie there",
        {.range = {0, int(io::ShardNumber::most)}});
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
