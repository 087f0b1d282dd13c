// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
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

Verb laminate_predict_verb() {
    auto arguments = std::make_shared<LaminatePredictArguments>();
    scattering::LaminatePredictJob& job = arguments->job;
    Verb command("predict", "Predict what a laminate reflects and transmits, and how far light spreads",
                 "\"W 0.3, K 0.1\" -o spread.json");
    command.add("laminate", job.laminate,
                "a laminate file (voxtone-laminate), or layers: \"W 0.3, K 0.1\" (mm, top first)",
                {.unit = "FILE|LAYERS", .required = true});
    command.add("-o,--out", job.files, "file to write, several by repeating: .json (the profiles) or .svg (drawn)",
                {.unit = "FILE", .one_each = true});
    add_overwrite_option(command, job.overwrite);
    command.add("--check", job.check, "Monte Carlo of the whole laminate beside it");
    add_named_laminate_options(command, job.setting);
    add_detail_options(command, job.setting.reach_mm, job.setting.coefficients);
    add_tracing_options(command, job.paths, job.seed);
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
