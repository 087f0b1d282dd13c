// SPDX-License-Identifier: GPL-3.0-or-later
//
// `calibrate edge photo`, and `calibrate edge simulate`, which takes the photographs that it reads.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/photo_options.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"

namespace voxtone::cli {

namespace {

struct EdgePhotoArguments {
    calibration::BenchPhotoJob job;
    std::string coding = "auto";
    std::vector<double> checker_corners;
    RunOptions run;
};

int run_edge_photo(EdgePhotoArguments& a, const CalibrateJobs& jobs) {
    a.job.light.coding = coding_of(a.coding);
    a.job.light.checker_corners = four_points(a.checker_corners);
    return run_on_console(a.run, [&](Progress& progress) { return jobs.edge_photo(a.job, progress); });
}

struct EdgeSimulateArguments {
    calibration::BenchSimulationJob job;
    std::vector<double> gel, field;
    RunOptions run;
};

int run_edge_simulate(EdgeSimulateArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        calibration::EdgeBench& bench = a.job.profiles.bench;
        if (!a.gel.empty()) bench.gel_from_mm = a.gel[0], bench.gel_to_mm = a.gel[1];
        if (!a.field.empty()) a.job.camera.width_mm = a.field[0], a.job.camera.height_mm = a.field[1];
        a.job.camera.seed = bench.seed;
        return jobs.edge_simulate(a.job, progress);
    });
}

void add_bench_faults(CLI::App& command, EdgeSimulateArguments& a) {
    const auto fault = [&](const char* name, double& value, const char* help) {
        add_value(command, name, value, help)->group("Faults of the bench");
    };
    calibration::EdgeBench& bench = a.job.profiles.bench;
    fault("--bias", bench.bias, "values of slabs are divided by it: the mu that a fit should find");
    fault("--noise", bench.noise, "standard error of a sample of reflectance 1 in the profiles");
    fault("--thickness-off", bench.thickness_off, "slabs are thicker than they are said to be, by this part");
    command.add_option("--gel", a.gel, "every layer of gel is drawn from this range, mm; empty: as in the setup")
        ->type_name("FROM,TO")
        ->delimiter(',')
        ->expected(2)
        ->group("Faults of the bench");
}

void add_bench_camera(CLI::App& command, EdgeSimulateArguments& a) {
    const char* group = "Photographs";
    calibration::BenchCameraOptions& camera = a.job.camera;
    command
        .add_option("--photos", a.job.photos,
                    "folder for photographs of the slabs, the bare sheet, a checker and white paper (16-bit TIFF), and "
                    "their list; pitch and blur are the setup's; empty: none")
        ->type_name("FOLDER")
        ->group(group);
    add_count(command, "--shots", a.job.shots, "photographs of every slab")->group(group);
    command.add_option("--field", a.field, "width and height of what the camera sees, mm")
        ->type_name("W,H")
        ->delimiter(',')
        ->expected(2)
        ->default_str("104,78")
        ->group(group);
    add_value(command, "--turn", camera.turn_deg, "of the sheet in the picture, degrees")->group(group);
    add_value(command, "--uneven", camera.uneven, "light lost across the 10 mm about the edge, a part of it")
        ->group(group);
    add_value(command, "--vignetting", camera.vignetting, "light lost in the picture's corners, a part of it")
        ->group(group);
    add_value(command, "--exposure", camera.exposure, "1: a perfect white is at 0.8 of full scale")->group(group);
    add_value(command, "--electrons", camera.electrons, "counted at full scale, for shot noise; 0: no noise")
        ->group(group);
    add_value(command, "--read-noise", camera.read_noise, "standard deviation, a part of full scale")->group(group);
    add_value(command, "--camera-colours", camera.matrix, "how much the camera's channels mix colours: 0 not at all")
        ->group(group);
    add_count(command, "--scratches", camera.scratches, "on every slab, about the edge")->group(group);
}

}  // namespace

Command add_calibrate_edge_photo_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgePhotoArguments>();
    EdgePhotoArguments& a = *arguments;
    CLI::App* command = edge.add_subcommand(
        "photo", "Measure the profiles across the edge in photographs of the slabs, for `edge fit`");
    command
        ->add_option("list", a.job.list,
                     "CSV of the photographs: file,shows,resin,thickness_mm; shows: checker, paper, sheet or slab")
        ->required()
        ->type_name("FILE");
    add_out_option(*command, a.job.out, "FILE", "profiles to write (.csv)");
    add_overwrite_option(*command, a.job.overwrite);
    command->add_option("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017")
        ->type_name("FILE");
    command
        ->add_option("--write-setup", a.job.new_setup,
                     "setup.json with the sheet, pitch, blur and white point's error that were measured; empty: none")
        ->type_name("FILE");
    command
        ->add_option("--overlays", a.job.overlays,
                     "folder for a picture of what was measured in each photograph; empty: beside the profiles, "
                     "NAME-overlays")
        ->type_name("FOLDER");
    add_value(*command, "--checker", a.job.checker, "chart: colorchecker24 or a file")->type_name("NAME|FILE");
    add_corners_option(*command, "--checker-corners", a.checker_corners,
                       "corners of the checker's patches in its picture, px, in order round it");
    add_coding_option(*command, a.coding);
    a.run.lengths.add(*command, "--square", a.job.square_mm, "edge of the checkerboard's squares");
    a.run.lengths.add(*command, "--along", a.job.length_mm, "length along the edge over which is averaged");
    add_run_options(*command, a.run);
    add_example(*command, "photographs.csv --write-setup setup.json -o profiles.csv");
    return [arguments, &jobs] { return run_edge_photo(*arguments, jobs); };
}

Command add_calibrate_edge_simulate_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeSimulateArguments>();
    EdgeSimulateArguments& a = *arguments;
    calibration::EdgeSimulationJob& job = a.job.profiles;
    CLI::App* command = edge.add_subcommand(
        "simulate",
        "Render the edge profiles that slabs of known resins would give, and photographs of them: a rehearsal\n"
        "without a bench");
    add_resins_option(*command, job.resins, ", RGB");
    command->add_option("--roles", job.roles, "resins of the set; empty: all")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--setup", job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017")
        ->type_name("FILE");
    command->add_option("--thickness", job.thickness_mm, "of the slabs, mm")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->default_str("0.5,1");
    add_out_option(*command, job.out, "FILE", "profiles to write (.csv)")->required(false);
    add_overwrite_option(*command, job.overwrite);
    add_bench_faults(*command, a);
    add_bench_camera(*command, a);
    add_count(*command, "--paths", job.bench.paths, "per resin, slab and channel");
    add_seed_option(*command, job.bench.seed, "seed of paths and noise");
    add_run_options(*command, a.run);
    add_example(*command, "--resins vero-opaque --setup setup.json --bias 0.913 --photos bench -o profiles.csv");
    return [arguments, &jobs] { return run_edge_simulate(*arguments, jobs); };
}

}  // namespace voxtone::cli
