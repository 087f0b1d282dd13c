// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <vector>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"

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

void add_camera_options(Verb& command, CalibrateSimulateProfileArguments& a) {
    calibration::SpotCamera& camera = a.job.camera;
    command.add("--exposures", camera.seconds, "exposure times, seconds, rising",
                {.unit = "S,S,...", .separator = ','});
    command.add("--size", camera.size_px, "edge of the square pictures, pixels");
    command.add("--mm-per-px", camera.mm_per_px, "width of a pixel on the slab, mm");
    a.offset.assign(camera.offset_px.begin(), camera.offset_px.end());
    command.add("--offset", a.offset, "of the spot from the picture's middle, pixels right and down",
                {.unit = "X,Y", .separator = ',', .count = {2, 2}});
    command.add("--spot", length(camera.spot_mm), "radius of the projected pixel and the pinhole");
    command.add("--blur", length(camera.blur_mm), "standard deviation of the camera's blur");
    command.add("--stretch", camera.stretch, "width of the spot over its height; 1: a camera straight above");
    command.add("--stray", camera.stray, "stray light, part of the light in the middle of the spot");
    command.add("--peak", camera.peak, "brightest pixel at the shortest exposure, part of full scale");
    command.add("--full-well", camera.full_well, "electrons at full scale; 0: no noise");
    command.add("--read-noise", camera.read_noise, "standard deviation, part of full scale");
    command.add("--black", camera.black, "what the camera writes without light, part of full scale");
    command.add("--bits", camera.bits, "of a sample");
}

}  // namespace

Verb calibrate_simulate_profile_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateSimulateProfileArguments>();
    CalibrateSimulateProfileArguments& a = *arguments;
    Verb command("simulate-profile",
                 "Draw the photographs that `calibrate profile` measures, of a slab of "
                 "a known resin: a rehearsal without a laboratory",
                 "vero-opaque W --thickness 3mm -o white");
    add_resins(command, a.job.resins, ", RGB");
    command.add("role", a.job.role, "resin of the slab: W, K, ...", {.unit = "ROLE", .required = true});
    command.add("--thickness", length(a.job.thickness_mm), "of the slab: 3mm", {.required = true});
    add_out_option(command, a.job.out, "FOLDER",
                   "folder for reflection-NN.exr, transmission-NN.exr, their -dark-NN.exr, card and lcd, truth.json");
    add_overwrite_option(command, a.job.overwrite);
    add_camera_options(command, a);
    command.add("--paths", a.job.paths, "traced per channel");
    command.add("--seed", a.job.camera.seed, "seed of paths and noise");
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
