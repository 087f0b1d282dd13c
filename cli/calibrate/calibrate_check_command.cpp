// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/patch_options.h"

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

Verb calibrate_check_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateCheckArguments>();
    CalibrateCheckArguments& a = *arguments;
    Verb command("check", "How well a resin set predicts measured patches, as CIEDE2000",
                 "my-resins.json other-patches.csv -o check.html");
    add_resins(command, a.job.resins);
    command.add("patches", a.job.patches, "CSV of measured patches", {.unit = "FILE", .required = true});
    command.add("-o,--out", a.job.page, "page to look at: patches measured and predicted", {.unit = "FILE.html"});
    add_overwrite_option(command, a.job.overwrite);
    add_patch_map_options(command, a.job.map);
    add_patch_options(command, a.patches, a.job.measured);
    a.run.console.answers = true;
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
