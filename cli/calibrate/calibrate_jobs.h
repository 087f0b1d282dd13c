// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the steps of `calibrate` do, apart from how they are told of: both programs of the command line declare the
// steps, so that help, completion and mistakes cost nothing, and voxtone-calibrate alone has the jobs, with OpenCV for
// the photographs and Ceres for the fits.
#pragma once

#include "calibration/bench/bench_photo_job.h"
#include "calibration/compare/compare_job.h"
#include "calibration/compare/print_regions.h"
#include "calibration/compare/print_spread.h"
#include "calibration/compare/refit_job.h"
#include "calibration/edge/dictionary_job.h"
#include "calibration/edge/edge_fit_job.h"
#include "calibration/edge/edge_samples_job.h"
#include "calibration/fit/check_job.h"
#include "calibration/fit/fit_job.h"
#include "calibration/fit/icc_job.h"
#include "calibration/photo/photo_job.h"
#include "calibration/rehearsal/bench_simulation_job.h"
#include "calibration/rehearsal/photo_simulation_job.h"
#include "calibration/rehearsal/profile_simulation_job.h"
#include "calibration/spot/profile_job.h"
#include "calibration/spot/response_sweep_job.h"
#include "calibration/target/target_job.h"

namespace voxtone::cli {

/// All null in `voxtone`, which runs none of them.
struct CalibrateJobs {
    JobResult (*check)(const calibration::CheckJob& job, Progress& progress) = nullptr;
    JobResult (*compare)(const calibration::CompareJob& job, const calibration::PredictPrint& predict,
                         Progress& progress) = nullptr;
    JobResult (*edge_dictionary)(const calibration::DictionaryJob& job, Progress& progress) = nullptr;
    JobResult (*edge_fit)(const calibration::EdgeFitJob& job, Progress& progress) = nullptr;
    JobResult (*edge_photo)(const calibration::BenchPhotoJob& job, Progress& progress) = nullptr;
    JobResult (*edge_samples)(const calibration::EdgeSamplesJob& job, const calibration::PrintBoxes& print,
                              Progress& progress) = nullptr;
    JobResult (*edge_simulate)(const calibration::BenchSimulationJob& job, Progress& progress) = nullptr;
    JobResult (*fit)(const calibration::FitJob& job, Progress& progress) = nullptr;
    JobResult (*icc)(const calibration::IccJob& job, Progress& progress) = nullptr;
    JobResult (*photo)(const calibration::PhotoJob& job, Progress& progress) = nullptr;
    JobResult (*profile)(const calibration::ProfileJob& job, Progress& progress) = nullptr;
    calibration::ExposureFile (*exposure)(const std::string& text) = nullptr;  ///< of a word, for `profile`
    JobResult (*responses)(const calibration::ResponseSweepJob& job, Progress& progress) = nullptr;
    JobResult (*refit)(const calibration::RefitJob& job, Progress& progress) = nullptr;
    bool (*is_regions)(const std::filesystem::path& file) = nullptr;  ///< of a photographed print
    JobResult (*simulate)(const calibration::PhotoSimulationJob& job, Progress& progress) = nullptr;
    JobResult (*simulate_profile)(const calibration::ProfileSimulationJob& job, Progress& progress) = nullptr;
    std::vector<Eigen::Vector3f> (*spread)(std::span<const Eigen::Vector3f> cells, int columns,
                                           const Eigen::Vector2d& sigma_cells) = nullptr;  ///< of droplets
    JobResult (*target)(const calibration::TargetJob& job, const calibration::PrintBoxes& print,
                        Progress& progress) = nullptr;
};

}  // namespace voxtone::cli
