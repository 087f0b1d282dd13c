// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/units.h"
#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "cli/program/help.h"
#include "cli/program/outcome.h"
#include "slicer/tray/tray_job.h"

namespace voxtone::cli {

namespace {

struct TrayArguments {
    std::vector<std::string> plan;
    std::string gap;
    JobArguments job;
    ConsoleOptions console;
};

slicer::TrayPlan plan_of(const TrayArguments& arguments) {
    const slicer::SliceOptions common = options_of(arguments.job);
    const std::string suffix = std::filesystem::path(arguments.plan[0]).extension().string();
    const bool is_plan = suffix == ".json" || suffix == ".csv";
    if (is_plan && arguments.plan.size() > 1)
        throw UsageError("tray: name one plan, or models and pictures; a plan names its parts itself");
    slicer::TrayPlan plan =
        is_plan ? slicer::read_tray_plan(arguments.plan[0], common) : slicer::tray_of_models(arguments.plan, common);
    if (!arguments.gap.empty()) plan.gap_mm = parse_length_mm(arguments.gap, "--gap");
    if (!(plan.gap_mm >= 0)) throw UsageError("--gap: is a length of 0 or more");
    return plan;
}

}  // namespace

Command add_tray_command(CLI::App& program) {
    auto arguments = std::make_shared<TrayArguments>();
    CLI::App* command = program.add_subcommand("tray", "Slice many parts, and copies of them, into one print");
    command
        ->add_option("plan", arguments->plan, "plan of the tray (.json, .csv), or the models and pictures themselves")
        ->required()
        ->type_name("FILE");
    command->add_option("--gap", arguments->gap, "between parts whose places are not given; 2mm where no plan says")
        ->type_name("LENGTH")
        ->group("Placement");
    add_job_options(*command, arguments->job, {"model", "layers", "shard", "until", "mixtures", "resume"});
    add_console_options(*command, arguments->console);
    add_example(*command, "tray.json -o out/tray");
    return [arguments] {
        return run_on_console(arguments->console,
                              [&](Progress& progress) { return slicer::run_tray_job(plan_of(*arguments), progress); });
    };
}

}  // namespace voxtone::cli
