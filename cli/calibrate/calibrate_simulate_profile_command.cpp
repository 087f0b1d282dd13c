// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"

namespace voxtone::cli {

namespace {

struct CalibrateSimulateProfileArguments {
    calibration::ProfileSimulationJob job;
    std::vector<double> offset;
    RunOptions run;
};

int run(CalibrateSimulateProfileArguments& a, const CalibrateJobs& jobs) {
    a.job.camera.offset_px = {a.offset[0], a.offset[1]};
    return run_on_console(a.run, [&](Progress& progress) { return jobs.simulate_profile(a.job, progress); });
}

void add_camera_options(CLI::App& command, CalibrateSimulateProfileArguments& a) {
    calibration::SpotCamera& camera = a.job.camera;
    add_value(command, "--exposures", camera.seconds, "exposure times, seconds, rising")
        ->type_name("S,S,...")
        ->delimiter(',');
    add_value(command, "--size", camera.size_px, "edge of the square pictures, pixels");
    add_value(command, "--mm-per-px", camera.mm_per_px, "width of a pixel on the slab, mm");
    a.offset.assign(camera.offset_px.begin(), camera.offset_px.end());
    add_value(command, "--offset", a.offset, "of the spot from the picture's middle, pixels right and down")
        ->type_name("X,Y")
        ->delimiter(',')
        ->expected(2);
    a.run.lengths.add(command, "--spot", camera.spot_mm, "radius of the projected pixel and the pinhole");
    a.run.lengths.add(command, "--blur", camera.blur_mm, "standard deviation of the camera's blur");
    add_value(command, "--stretch", camera.stretch, "width of the spot over its height; 1: a camera straight above");
    add_value(command, "--stray", camera.stray, "stray light, part of the light in the middle of the spot");
    add_value(command, "--peak", camera.peak, "brightest pixel at the shortest exposure, part of full scale");
    add_value(command, "--full-well", camera.full_well, "electrons at full scale; 0: no noise");
    add_value(command, "--read-noise", camera.read_noise, "standard deviation, part of full scale");
    add_value(command, "--black", camera.black, "what the camera writes without light, part of full scale");
    add_value(command, "--bits", camera.bits, "of a sample");
}

}  // namespace

Command add_calibrate_simulate_profile_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateSimulateProfileArguments>();
    CalibrateSimulateProfileArguments& a = *arguments;
    CLI::App* command = calibrate.add_subcommand("simulate-profile",
                                                 "Draw the photographs that `calibrate profile` measures, of a slab of "
                                                 "a known resin: a rehearsal without a laboratory");
    add_resins_option(*command, a.job.resins, ", RGB", "resins")->required();
    command->add_option("role", a.job.role, "resin of the slab: W, K, ...")->type_name("ROLE")->required();
    a.run.lengths.add_required(*command, "--thickness", a.job.thickness_mm, "of the slab: 3mm");
    add_out_option(*command, a.job.out, "FOLDER",
                   "folder for reflection-NN.exr, transmission-NN.exr, their -dark-NN.exr, truth.json");
    add_overwrite_option(*command, a.job.overwrite);
    add_camera_options(*command, a);
    add_value(*command, "--paths", a.job.paths, "traced per channel");
    add_value(*command, "--seed", a.job.camera.seed, "seed of paths and noise");
    add_run_options(*command, a.run);
    add_example(*command, "vero-opaque W --thickness 3mm -o white");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

}  // namespace voxtone::cli
