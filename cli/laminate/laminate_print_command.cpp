// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
#include "cli/program/help.h"
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

Command add_laminate_print_command(CLI::App& laminate) {
    auto arguments = std::make_shared<LaminatePrintArguments>();
    scattering::LaminatePrintJob& job = arguments->job;
    LengthOptions& lengths = arguments->run.lengths;
    CLI::App* command = laminate.add_subcommand("print", "Make printable slabs of laminates, side by side");
    command
        ->add_option("laminates", job.laminates,
                     "laminate files (voxtone-laminate), or layers: \"W 0.3, K 0.1\" (mm, top first)")
        ->type_name("FILE|LAYERS")
        ->required();
    add_stack_folder_options(*command, job.out, job.overwrite);
    add_printer_option(*command, job.printer);
    add_laminate_resins_option(*command, job.resins);
    lengths.add(*command, "--width", job.width_mm, "of a slab, along x");
    lengths.add(*command, "--depth", job.depth_mm, "of a slab, along y");
    lengths.add(*command, "--gap", job.gap_mm, "between slabs");
    command
        ->add_option(
            "--base", job.base,
            "a layer below each slab, such as K=1mm: laminates searched on black lie on black then; empty: none")
        ->type_name("ROLE=LENGTH");
    command->add_flag("--gcvf", job.outputs.gcvf, "write a GCVF container too");
    add_run_options(*command, arguments->run);
    add_example(*command, "\"W 0.3, K 0.1\" -o out/slab");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
