// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"

namespace voxtone::cli {

namespace {

struct CalibrateSimulateArguments {
    calibration::PhotoSimulationJob job;
    std::vector<double> white_balance;
    bool no_checker = false, ideal = false;
    RunOptions run;
};

int run(CalibrateSimulateArguments& a, const CalibrateJobs& jobs) {
    a.job.mixtures = a.ideal ? calibration::MixtureKind::ideal : calibration::MixtureKind::dithered;
    a.job.photo.checker = !a.no_checker;
    a.job.photo.white_balance = {a.white_balance[0], a.white_balance[1], a.white_balance[2]};
    return run_on_console(a.run, [&](Progress& progress) { return jobs.simulate(a.job, progress); });
}

void add_geometry_options(CLI::App& command, calibration::PhotoOptions& photo) {
    add_value(command, "--width", photo.width_px, "pixels");
    add_value(command, "--height", photo.height_px, "pixels");
    add_value(command, "--tilt-x", photo.tilt_x_deg, "camera tilted, degrees");
    add_value(command, "--tilt-y", photo.tilt_y_deg, "camera tilted, degrees");
    add_value(command, "--turn", photo.turn_deg, "picture turned, degrees");
    add_value(command, "--distance", photo.distance, "of the camera, in widths of the scene");
    add_value(command, "--lamp", photo.lamp_mm, "distance of the lamp in mm, 0: far away");
    add_value(command, "--lamp-azimuth", photo.lamp_azimuth_deg, "where the lamp stands, degrees");
}

void add_camera_options(CLI::App& command, calibration::PhotoOptions& photo, std::vector<double>& white_balance) {
    add_value(command, "--blur", photo.blur_px, "standard deviation of the blur in pixels");
    add_value(command, "--vignetting", photo.vignetting, "light lost in the corners");
    add_value(command, "--exposure", photo.exposure, "1: a perfect white is at 80 % of full scale");
    white_balance.assign(photo.white_balance.begin(), photo.white_balance.end());
    add_value(command, "--white-balance", white_balance, "gains of red, green, blue")->delimiter(',')->expected(3);
    add_value(command, "--matrix", photo.matrix, "how much the camera mixes colours: 0 not at all, 1 as cameras do");
    add_value(command, "--electrons", photo.electrons, "at full scale: shot noise; 0: no noise");
    add_value(command, "--read-noise", photo.read_noise, "standard deviation, of full scale");
}

void add_dirt_options(CLI::App& command, calibration::PhotoOptions& photo) {
    add_value(command, "--dust", photo.dust, "specks");
    add_value(command, "--scratches", photo.scratches, "scratches");
    command.add_flag("--mirrored", photo.mirrored, "as on a printer that mirrors");
    add_value(command, "--checker-turns", photo.checker_turns, "quarter turns of the chart");
    add_value(command, "--checker-error", photo.checker_error,
              "relative deviation of the chart's patches from what is known of them");
    add_value(command, "--seed", photo.seed, "seed of noise and dirt");
}

}  // namespace

Command add_calibrate_simulate_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateSimulateArguments>();
    CalibrateSimulateArguments& a = *arguments;
    CLI::App* command = calibrate.add_subcommand(
        "simulate",
        "Draw the photograph that a target would give if printed with known resins: a rehearsal without a printer");
    command->add_option("target", a.job.target, "description of the target (target.json)")
        ->type_name("FILE")
        ->required();
    add_resins_option(*command, a.job.resins);
    add_out_option(
        *command, a.job.out, "FILE",
        "photograph to write: .png, .tif (16 bits, linear) or .exr; of a chart .csv, what a spectrophotometer reads");
    add_overwrite_option(*command, a.job.overwrite);
    command->add_option("--truth", a.job.truth, "write what the squares truly reflect, as a patch table")
        ->type_name("FILE");
    add_value(*command, "--checker", a.job.checker, "chart beside the target: colorchecker24 or a file")
        ->type_name("NAME|FILE");
    command->add_flag(
        "--ideal", a.ideal,
        "mixtures are ideal (fit them without --printer); else they are dithers of the printer's voxels, as they "
        "are printed");
    command->add_flag("--no-checker", a.no_checker, "no chart in the picture");
    command->add_flag("--8-bits", a.job.eight_bits, "a PNG of 8-bit sRGB codes");
    add_geometry_options(*command, a.job.photo);
    add_camera_options(*command, a.job.photo, a.white_balance);
    add_dirt_options(*command, a.job.photo);
    add_value(*command, "--lab-noise", a.job.lab_noise, "a table of a chart: standard deviation of L, a and b");
    add_run_options(*command, a.run);
    add_example(*command, "target/target.json -o rehearsal.tif");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

}  // namespace voxtone::cli
