// SPDX-License-Identifier: GPL-3.0-or-later
//
// `calibrate edge photo`, and `calibrate edge simulate`, which takes the photographs that it reads.
#include <memory>
#include <string>
#include <vector>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/photo_options.h"
#include "cli/program/common_options.h"

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

void add_bench_faults(Verb& command, EdgeSimulateArguments& a) {
    const auto fault = [&](const char* name, double& value, const char* help) {
        command.add(name, value, help, {.group = "Faults of the bench"});
    };
    calibration::EdgeBench& bench = a.job.profiles.bench;
    fault("--bias", bench.bias, "values of slabs are divided by it: the mu that a fit should find");
    fault("--noise", bench.noise, "standard error of a sample of reflectance 1 in the profiles");
    fault("--thickness-off", bench.thickness_off, "slabs are thicker than they are said to be, by this part");
    command.add("--gel", a.gel, "every layer of gel is drawn from this range, mm; empty: as in the setup",
                {.unit = "FROM,TO", .separator = ',', .count = {2, 2}, .group = "Faults of the bench"});
}

void add_bench_camera(Verb& command, EdgeSimulateArguments& a) {
    const char* group = "Photographs";
    calibration::BenchCameraOptions& camera = a.job.camera;
    command.add("--photos", a.job.photos,
                "folder for photographs of the slabs, the bare sheet, a checker and white paper (16-bit TIFF), and "
                "their list; pitch and blur are the setup's; empty: none",
                {.unit = "FOLDER", .group = group});
    command.add("--shots", a.job.shots, "photographs of every slab", {.group = group});
    command.add("--field", a.field, "width and height of what the camera sees, mm",
                {.unit = "W,H", .usual = "104,78", .separator = ',', .count = {2, 2}, .group = group});
    command.add("--turn", camera.turn_deg, "of the sheet in the picture, degrees", {.group = group});
    command.add("--uneven", camera.uneven, "light lost across the 10 mm about the edge, a part of it",
                {.group = group});
    command.add("--vignetting", camera.vignetting, "light lost in the picture's corners, a part of it",
                {.group = group});
    command.add("--exposure", camera.exposure, "1: a perfect white is at 0.8 of full scale", {.group = group});
    command.add("--electrons", camera.electrons, "counted at full scale, for shot noise; 0: no noise",
                {.group = group});
    command.add("--read-noise", camera.read_noise, "standard deviation, a part of full scale", {.group = group});
    command.add("--camera-colours", camera.matrix, "how much the camera's channels mix colours: 0 not at all",
                {.group = group});
    command.add("--scratches", camera.scratches, "on every slab, about the edge", {.group = group});
}

}  // namespace

Verb calibrate_edge_photo_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgePhotoArguments>();
    EdgePhotoArguments& a = *arguments;
    Verb command("photo", "Measure the profiles across the edge in photographs of the slabs, for `edge fit`",
                 "photographs.csv --write-setup setup.json -o profiles.csv");
    command.add("list", a.job.list,
                "CSV of the photographs: file,shows,resin,thickness_mm; shows: checker, paper, sheet or slab",
                {.unit = "FILE", .required = true});
    add_out_option(command, a.job.out, "FILE", "profiles to write (.csv)");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017",
                {.unit = "FILE"});
    command.add("--write-setup", a.job.new_setup,
                "setup.json with the sheet, pitch, blur and white point's error that were measured; empty: none",
                {.unit = "FILE"});
    command.add("--overlays", a.job.overlays,
                "folder for a picture of what was measured in each photograph; empty: beside the profiles, "
                "NAME-overlays",
                {.unit = "FOLDER"});
    command.add("--checker", a.job.checker, "chart: colorchecker24 or a file", {.unit = "NAME|FILE"});
    add_corners_option(command, "--checker-corners", a.checker_corners,
                       "corners of the checker's patches in its picture, px, in order round it");
    add_coding_option(command, a.coding);
    command.add("--square", length(a.job.square_mm), "edge of the checkerboard's squares");
    command.add("--along", length(a.job.length_mm), "length along the edge over which is averaged");
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run_edge_photo(*arguments, jobs); };
    return command;
}

Verb calibrate_edge_simulate_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeSimulateArguments>();
    EdgeSimulateArguments& a = *arguments;
    calibration::EdgeSimulationJob& job = a.job.profiles;
    Verb command(
        "simulate",
        "Render the edge profiles that slabs of known resins would give, and photographs of them: a rehearsal\n"
        "without a bench",
        "--resins vero-opaque --setup setup.json --bias 0.913 --photos bench -o profiles.csv");
    add_resins_option(command, job.resins, ", RGB");
    command.add("--roles", job.roles, "resins of the set; empty: all",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--setup", job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017",
                {.unit = "FILE"});
    command.add("--thickness", job.thickness_mm, "of the slabs, mm",
                {.unit = "LIST", .one_each = true, .separator = ','});
    add_out_option(command, job.out, "FILE", "profiles to write (.csv)", false);
    add_overwrite_option(command, job.overwrite);
    add_bench_faults(command, a);
    add_bench_camera(command, a);
    command.add("--paths", job.bench.paths, "per resin, slab and channel");
    command.add("--seed", job.bench.seed, "seed of paths and noise");
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run_edge_simulate(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
