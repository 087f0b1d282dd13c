// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate` and its steps, and `voxtone compare`, one file each; what they run is one of `jobs`, which
// outlive them.
#pragma once

#include "cli/calibrate/calibrate_jobs.h"
#include "cli/program/verb.h"

namespace voxtone::cli {

[[nodiscard]] Verb calibrate_verb(const CalibrateJobs& jobs);

[[nodiscard]] Verb compare_verb(const CalibrateJobs& jobs);

[[nodiscard]] Verb calibrate_target_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_chart_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_simulate_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_photo_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_fit_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_check_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_icc_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_responses_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_profile_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_simulate_profile_verb(const CalibrateJobs& jobs);

/// A family by itself, `calibrate edge`, with its steps.
[[nodiscard]] Verb calibrate_edge_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_edge_chart_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_edge_dictionary_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_edge_fit_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_edge_photo_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_edge_samples_verb(const CalibrateJobs& jobs);
[[nodiscard]] Verb calibrate_edge_simulate_verb(const CalibrateJobs& jobs);

}  // namespace voxtone::cli
