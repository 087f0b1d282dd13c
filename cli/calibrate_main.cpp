// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-calibrate: what `voxtone calibrate` becomes (cli/calibrate_program.h), with the same command line.
#include "voxtone/base/cancel_on_signal.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/calibrate_jobs.h"
#include "voxtone/cli/program.h"

namespace {

constexpr voxtone::cli::CalibrateJobs jobs{.check = voxtone::calibration::run_check_job,
                                           .fit = voxtone::calibration::run_fit_job,
                                           .photo = voxtone::calibration::run_photo_job,
                                           .profile = voxtone::calibration::run_profile_job,
                                           .exposure = voxtone::calibration::parse_exposure,
                                           .simulate = voxtone::calibration::run_photo_simulation,
                                           .simulate_profile = voxtone::calibration::run_profile_simulation,
                                           .target = voxtone::calibration::run_target_job};

}  // namespace

int main(int argc, char** argv) {
    using namespace voxtone::cli;
    voxtone::catch_stop_signals();
    const auto add = [](CLI::App& program) { return add_calibrate_command(program, jobs); };
    return run_program(command_words(argc, argv), {{"calibrate", add}});
}
