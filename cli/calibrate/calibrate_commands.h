// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate` and its steps, and `voxtone compare`, one file each; what they run is one of `jobs`, which
// outlive them.
#pragma once

#include "cli/calibrate/calibrate_jobs.h"
#include "cli/program/command.h"

namespace voxtone::cli {

Command add_calibrate_command(CLI::App& program, const CalibrateJobs& jobs);

Command add_compare_command(CLI::App& program, const CalibrateJobs& jobs);

Command add_calibrate_target_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_chart_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_simulate_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_photo_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_fit_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_check_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_icc_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_profile_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_simulate_profile_command(CLI::App& calibrate, const CalibrateJobs& jobs);

/// A family by itself, `calibrate edge`, with its steps.
Command add_calibrate_edge_command(CLI::App& calibrate, const CalibrateJobs& jobs);
Command add_calibrate_edge_chart_command(CLI::App& edge, const CalibrateJobs& jobs);
Command add_calibrate_edge_dictionary_command(CLI::App& edge, const CalibrateJobs& jobs);
Command add_calibrate_edge_fit_command(CLI::App& edge, const CalibrateJobs& jobs);
Command add_calibrate_edge_photo_command(CLI::App& edge, const CalibrateJobs& jobs);
Command add_calibrate_edge_samples_command(CLI::App& edge, const CalibrateJobs& jobs);
Command add_calibrate_edge_simulate_command(CLI::App& edge, const CalibrateJobs& jobs);

}  // namespace voxtone::cli
