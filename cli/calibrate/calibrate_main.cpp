// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-calibrate: what `voxtone calibrate` and `voxtone compare` become (cli/calibrate/calibrate_program.h), with
// the same command line.
#include "base/cancel_on_signal.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/calibrate_jobs.h"
#include "cli/program/program.h"

namespace {

constexpr voxtone::cli::CalibrateJobs jobs{.check = voxtone::calibration::run_check_job,
                                           .compare = voxtone::calibration::run_compare_job,
                                           .edge_dictionary = voxtone::calibration::run_dictionary_job,
                                           .edge_fit = voxtone::calibration::run_edge_fit_job,
                                           .edge_photo = voxtone::calibration::run_bench_photo_job,
                                           .edge_samples = voxtone::calibration::run_edge_samples_job,
                                           .edge_simulate = voxtone::calibration::run_bench_simulation,
                                           .fit = voxtone::calibration::run_fit_job,
                                           .icc = voxtone::calibration::run_icc_job,
                                           .photo = voxtone::calibration::run_photo_job,
                                           .profile = voxtone::calibration::run_profile_job,
                                           .exposure = voxtone::calibration::parse_exposure,
                                           .responses = voxtone::calibration::run_response_sweep,
                                           .refit = voxtone::calibration::run_refit_job,
                                           .is_regions = voxtone::calibration::is_region_sheet,
                                           .simulate = voxtone::calibration::run_photo_simulation,
                                           .simulate_profile = voxtone::calibration::run_profile_simulation,
                                           .spread = voxtone::calibration::spread_cells,
                                           .target = voxtone::calibration::run_target_job};

}  // namespace

#ifdef __SANITIZE_ADDRESS__
// OpenCV keeps tables of its conversion to Lab until the process ends, on the heap. Only whole stacks show whose they
// are: OpenCV is built without frame pointers.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "fast_unwind_on_malloc=0"; }
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:cv::hal::cvtBGRtoLab\n"; }
#endif

int main(int argc, char** argv) {
    using namespace voxtone::cli;
    voxtone::catch_stop_signals();
    return run_program(command_words(argc, argv), {compare_verb(jobs), calibrate_verb(jobs)});
}
