// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/help.h"
#include "cli/program/steps.h"

namespace voxtone::cli {

Command add_calibrate_command(CLI::App& program, const CalibrateJobs& jobs) {
    CLI::App* command = program.add_subcommand(
        "calibrate",
        "Find the resins' albedo and extinction from one printed and photographed (or measured) target, or measure how "
        "light spreads in a slab");
    add_example(*command, "fit patches.csv --resins C,M,Y,K,W -o my-resins.json");
    std::vector<AddStep> steps;
    for (const auto add : {add_calibrate_chart_command, add_calibrate_check_command, add_calibrate_edge_command,
                           add_calibrate_fit_command, add_calibrate_icc_command, add_calibrate_photo_command,
                           add_calibrate_profile_command, add_calibrate_simulate_command,
                           add_calibrate_simulate_profile_command, add_calibrate_target_command})
        steps.emplace_back([add, &jobs](CLI::App& calibrate) { return add(calibrate, jobs); });
    return add_steps(*command, steps);
}

}  // namespace voxtone::cli
