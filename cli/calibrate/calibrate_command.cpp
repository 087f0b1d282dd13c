// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate/calibrate_commands.h"

namespace voxtone::cli {

Verb calibrate_verb(const CalibrateJobs& jobs) {
    Verb command(
        "calibrate",
        "Find the resins' albedo and extinction from one printed and photographed (or measured) target, or measure how "
        "light spreads in a slab",
        "fit patches.csv --resins C,M,Y,K,W -o my-resins.json");
    command.steps = {calibrate_chart_verb(jobs),    calibrate_check_verb(jobs),
                     calibrate_edge_verb(jobs),     calibrate_fit_verb(jobs),
                     calibrate_icc_verb(jobs),      calibrate_photo_verb(jobs),
                     calibrate_profile_verb(jobs),  calibrate_responses_verb(jobs),
                     calibrate_simulate_verb(jobs), calibrate_simulate_profile_verb(jobs),
                     calibrate_target_verb(jobs)};
    return command;
}

}  // namespace voxtone::cli
