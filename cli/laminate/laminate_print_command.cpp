// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
#include "scattering/jobs/laminate_print_job.h"

namespace voxtone::cli {

namespace {

struct LaminatePrintArguments {
    scattering::LaminatePrintJob job;
    RunOptions run;
};

int run(LaminatePrintArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_print(a.job, progress); });
}

}  // namespace

Verb laminate_print_verb() {
    auto arguments = std::make_shared<LaminatePrintArguments>();
    scattering::LaminatePrintJob& job = arguments->job;
    Verb command("print", "Make printable slabs of laminates, side by side", "\"W 0.3, K 0.1\" -o out/slab");
    command.add("laminates", job.laminates,
                "laminate files (voxtone-laminate), or layers: \"W 0.3, K 0.1\" (mm, top first)",
                {.unit = "FILE|LAYERS", .required = true});
    add_stack_folder_options(command, job.out, job.overwrite);
    add_printer_option(command, job.printer);
    add_laminate_resins_option(command, job.resins);
    command.add("--width", length(job.width_mm), "of a slab, along x");
    command.add("--depth", length(job.depth_mm), "of a slab, along y");
    command.add("--gap", length(job.gap_mm), "between slabs");
    command.add("--base", job.base,
                "a layer below each slab, such as K=1mm: laminates searched on black lie on black then; empty: none",
                {.unit = "ROLE=LENGTH"});
    command.add("--gcvf", job.outputs.gcvf, "write a GCVF container too");
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
