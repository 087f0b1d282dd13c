// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "farm/batch/plan_estimate.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/print/estimate_job.h"
#include "slicer/print/estimate_text.h"
#include "slicer/print/run_print.h"

namespace voxtone::cli {

namespace {

struct EstimateArguments {
    JobArguments job;
    slicer::EstimateScope scope;
    bool quick = false;
    ConsoleOptions console;
};

/// What the command line says holds for all jobs that do not say otherwise.
farm::PlanOptions plan_of(const slicer::SliceOptions& options) {
    farm::PlanOptions plan;
    plan.plan = {options.model};
    plan.out = options.out.empty() ? "." : options.out;
    plan.begin_with = options;
    return plan;
}

int run(const EstimateArguments& arguments) {
    const slicer::SliceOptions options = options_of(arguments.job);
    slicer::EstimateScope scope = arguments.scope;
    scope.resins = !arguments.quick;
    return run_on_console(arguments.console, [&](Progress& progress) {
        const slicer::TrayModels models = many_models(arguments.job, options);
        if (models.empty() && farm::is_plan(options.model) && !slicer::is_tray_plan(options.model)) {
            if (scope.orientations)
                throw UsageError(
                    "--orientations is a table of one body; name its model, and not a plan of several jobs");
            return farm::run_plan_estimate(plan_of(options), scope, progress);
        }
        const slicer::JobEstimate estimate = slicer::estimate_print({options, models}, progress, scope);
        return JobResult{slicer::estimate_json(estimate), slicer::estimate_text(estimate), estimate.exit_code};
    });
}

}  // namespace

Verb estimate_verb() {
    auto arguments = std::make_shared<EstimateArguments>();
    Verb command(
        "estimate",
        "Say what slicing would take, without doing it: size, layers, resins, time, memory, disk. In the place of a "
        "model "
        "also of a plan as `batch` takes it (table, job list, folder, pattern): a line a job, and what they add up to. "
        "Several models are a tray, as of `slice`",
        "cow.obj --size 60mm");
    arguments->job.takes_many = true;
    add_job_options(command, arguments->job);
    command.add("--orientations", arguments->scope.orientations,
                "add a table of the ways to turn the body by right angles, the best first: height, layers, what "
                "hangs over, which "
                "coloured faces lie downward",
                {.group = "Run"});
    command.add("--quick", arguments->quick,
                "leave out how much of each resin: colours are not separated, which takes most of the time",
                {.group = "Run"});
    arguments->console.answers = true;
    add_console_options(command, arguments->console);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
