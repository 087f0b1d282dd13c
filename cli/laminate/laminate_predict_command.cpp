// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
#include "cli/program/help.h"
#include "scattering/jobs/laminate_predict_job.h"

namespace voxtone::cli {

namespace {

struct LaminatePredictArguments {
    scattering::LaminatePredictJob job;
    RunOptions run;
};

int run(LaminatePredictArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_predict(a.job, progress); });
}

}  // namespace

Command add_laminate_predict_command(CLI::App& laminate) {
    auto arguments = std::make_shared<LaminatePredictArguments>();
    scattering::LaminatePredictJob& job = arguments->job;
    CLI::App* command =
        laminate.add_subcommand("predict", "Predict what a laminate reflects and transmits, and how far light spreads");
    command
        ->add_option("laminate", job.laminate,
                     "a laminate file (voxtone-laminate), or layers: \"W 0.3, K 0.1\" (mm, top first)")
        ->type_name("FILE|LAYERS")
        ->required();
    command
        ->add_option("-o,--out", job.files, "file to write, several by repeating: .json (the profiles) or .svg (drawn)")
        ->type_name("FILE")
        ->allow_extra_args(false);
    add_overwrite_option(*command, job.overwrite);
    command->add_flag("--check", job.check, "Monte Carlo of the whole laminate beside it");
    add_named_laminate_options(*command, job.setting);
    add_detail_options(*command, arguments->run.lengths, job.setting.reach_mm, job.setting.coefficients);
    add_tracing_options(*command, job.paths, job.seed);
    add_run_options(*command, arguments->run);
    add_example(*command, "\"W 0.3, K 0.1\" -o spread.json");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
