// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
#include "scattering/jobs/laminate_trace_job.h"

namespace voxtone::cli {

namespace {

struct LaminateTraceArguments {
    scattering::LaminateTraceJob job;
    RunOptions run;
};

int run(LaminateTraceArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_trace(a.job, progress); });
}

}  // namespace

Verb laminate_trace_verb() {
    auto arguments = std::make_shared<LaminateTraceArguments>();
    scattering::LaminateTraceJob& job = arguments->job;
    Verb command(
        "trace",
        "Trace how light spreads in the voxels of a layered print, beside what its map asks: R and its width by "
        "cluster, and the error by area",
        "out/slab --dataset marble.bssrdf -o slab.png");
    command.add("stack", job.stack, "folder that `slice --show layered-profile` made of a map's picture",
                {.unit = "OUT", .required = true});
    command.add("-o,--out", job.files,
                "file to write, several by repeating: .png (albedo, distance and a response, column by column), .svg "
                "(R(r) of the largest clusters) or .bssrdf (R of the printed voxels)",
                {.unit = "FILE", .one_each = true});
    add_overwrite_option(command, job.overwrite);
    command.add("--dataset", job.dataset,
                "data set that the map was made from: what was asked and its factors are set beside it",
                {.unit = "FILE"});
    command.add("--profiles", job.profiles, "map of the print, where it is not where its job.json says",
                {.unit = "FILE"});
    add_resins_option(command, job.resins, "; empty: those it was made with");
    command.add("--paths", job.paths, "per pixel of the map and channel", {.range = {1, 1 << 24}});
    command.add("--seed", job.seed, "seed of traced light");
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
