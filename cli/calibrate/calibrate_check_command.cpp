// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/patch_options.h"
#include "cli/program/help.h"

namespace voxtone::cli {

namespace {

struct CalibrateCheckArguments {
    calibration::CheckJob job;
    PatchOptions patches;
    RunOptions run;
};

int run(CalibrateCheckArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        set_patch_model(a.patches, a.job.model, a.job.measured);
        return jobs.check(a.job, progress);
    });
}

}  // namespace

Command add_calibrate_check_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateCheckArguments>();
    CalibrateCheckArguments& a = *arguments;
    CLI::App* command =
        calibrate.add_subcommand("check", "How well a resin set predicts measured patches, as CIEDE2000");
    add_resins_option(*command, a.job.resins, {}, "resins")->required();
    command->add_option("patches", a.job.patches, "CSV of measured patches")->required()->type_name("FILE");
    command->add_option("-o,--out", a.job.page, "page to look at: patches measured and predicted")
        ->type_name("FILE.html");
    add_overwrite_option(*command, a.job.overwrite);
    add_patch_map_options(*command, a.job.map);
    add_patch_options(*command, a.run.lengths, a.patches, a.job.measured);
    a.run.console.answers = true;
    add_run_options(*command, a.run);
    add_example(*command, "my-resins.json other-patches.csv -o check.html");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

}  // namespace voxtone::cli
