// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "slicer/predict/top_print.h"

namespace voxtone::cli {

namespace {

struct CalibrateSimulateArguments {
    calibration::PhotoSimulationJob job;
    std::vector<double> white_balance;
    bool no_checker = false, ideal = false;
    double spread_mm = 0;
    std::optional<std::size_t> paths;
    RunOptions run;
};

/// A print by light paths, cell by cell of what an eye resolves.
calibration::FlatThing print_of(const CalibrateSimulateArguments& a, const CalibrateJobs& jobs, Progress& progress) {
    slicer::PredictOptions predict;
    predict.stack = a.job.target;
    predict.resins = a.job.resins;
    predict.model = "monte-carlo";
    predict.quality.paths = std::uint32_t(a.paths.value_or(256));  // less noise than a camera's, cell by cell
    predict.quality.seed = a.job.photo.seed;
    predict.threads = a.run.threads;
    const auto top = std::make_shared<slicer::TopPrint>(slicer::predict_top_picture(predict, progress));
    const Eigen::Vector2d cell_mm(top->cell_mm[0], top->cell_mm[1]);
    if (a.spread_mm > 0) top->rgb = jobs.spread(top->rgb, top->columns, a.spread_mm * cell_mm.cwiseInverse());
    const Eigen::Vector2d size_mm = Eigen::Vector2d(top->columns, top->rows).cwiseProduct(cell_mm);
    return {size_mm, [top, cell_mm, size_mm](const Eigen::Vector2d& p) -> Eigen::Vector3d {
                const int column = std::clamp(int(p.x() / cell_mm.x()), 0, top->columns - 1);
                const int row = std::clamp(int((size_mm.y() - p.y()) / cell_mm.y()), 0, top->rows - 1);
                return top->rgb[std::size_t(row) * std::size_t(top->columns) + std::size_t(column)].cast<double>();
            }};
}

int run(CalibrateSimulateArguments& a, const CalibrateJobs& jobs) {
    if (std::filesystem::is_directory(a.job.target))
        a.job.print = [&](Progress& progress) { return print_of(a, jobs, progress); };
    else if (a.spread_mm > 0 || a.paths)
        throw UsageError(
            fmt::format("{} is of a print; {} is no output folder of `slice`, and squares are read in their middle. "
                        "Leave it out.",
                        a.paths ? "--paths" : "--spread", a.job.target));
    if (a.job.resins.empty() && !a.job.print) a.job.resins = calibration::PhotoSimulationJob{}.resins;
    a.job.mixtures = a.ideal ? calibration::MixtureKind::ideal : calibration::MixtureKind::dithered;
    a.job.photo.checker = !a.no_checker;
    a.job.photo.white_balance = {a.white_balance[0], a.white_balance[1], a.white_balance[2]};
    return run_on_console(a.run, [&](Progress& progress) { return jobs.simulate(a.job, progress); });
}

void add_geometry_options(Verb& command, calibration::PhotoOptions& photo) {
    command.add("--width", photo.width_px, "pixels");
    command.add("--height", photo.height_px, "pixels");
    command.add("--tilt-x", photo.tilt_x_deg, "camera tilted, degrees");
    command.add("--tilt-y", photo.tilt_y_deg, "camera tilted, degrees");
    command.add("--turn", photo.turn_deg, "picture turned, degrees");
    command.add("--distance", photo.distance, "of the camera, in widths of the scene");
    command.add("--lamp", photo.lamp_mm, "distance of the lamp in mm, 0: far away");
    command.add("--lamp-azimuth", photo.lamp_azimuth_deg, "where the lamp stands, degrees");
}

void add_camera_options(Verb& command, calibration::PhotoOptions& photo, std::vector<double>& white_balance) {
    command.add("--blur", photo.blur_px, "standard deviation of the blur in pixels");
    command.add("--vignetting", photo.vignetting, "light lost in the corners");
    command.add("--margin", photo.margin, "of the picture, free on each side");
    command.add("--sheet", photo.sheet, "reflectance of what all lies on");
    command.add("--exposure", photo.exposure, "1: a perfect white is at 80 % of full scale");
    white_balance.assign(photo.white_balance.begin(), photo.white_balance.end());
    command.add("--white-balance", white_balance, "gains of red, green, blue", {.separator = ',', .count = {3, 3}});
    command.add("--matrix", photo.matrix, "how much the camera mixes colours: 0 not at all, 1 as cameras do");
    command.add("--electrons", photo.electrons, "at full scale: shot noise; 0: no noise");
    command.add("--read-noise", photo.read_noise, "standard deviation, of full scale");
}

void add_dirt_options(Verb& command, calibration::PhotoOptions& photo) {
    command.add("--dust", photo.dust, "specks");
    command.add("--scratches", photo.scratches, "scratches");
    command.add("--mirrored", photo.mirrored, "as on a printer that mirrors");
    command.add("--checker-turns", photo.checker_turns, "quarter turns of the chart");
    command.add("--checker-error", photo.checker_error,
                "relative deviation of the chart's patches from what is known of them");
    command.add("--seed", photo.seed, "seed of noise and dirt");
}

}  // namespace

Verb calibrate_simulate_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateSimulateArguments>();
    CalibrateSimulateArguments& a = *arguments;
    Verb command("simulate",
                 "Draw the photograph that a target or a print would give if printed with known resins: a rehearsal "
                 "without a printer",
                 "target/target.json -o rehearsal.tif");
    command.add("target", a.job.target,
                "description of the target (target.json), or of a flat print the output folder of `slice`",
                {.unit = "FILE|OUT", .required = true});
    const std::string of_target = std::exchange(a.job.resins, {});
    add_resins_option(command, a.job.resins, "; empty: of a print that of its job, of a target " + of_target);
    add_out_option(
        command, a.job.out, "FILE",
        "photograph to write: .png, .tif (16 bits, linear) or .exr; of a chart .csv, what a spectrophotometer reads");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--truth", a.job.truth, "write what the squares truly reflect, as a patch table", {.unit = "FILE"});
    command.add("--checker", a.job.checker, "chart beside the target: colorchecker24 or a file", {.unit = "NAME|FILE"});
    command.add(
        "--ideal", a.ideal,
        "mixtures are ideal (fit them without --printer); else they are dithers of the printer's voxels, as they "
        "are printed");
    command.add("--spread", length(a.spread_mm), "of a print: droplets run wider by this standard deviation",
                {.range = {0.0, 1.0}});
    command.add("--paths", a.paths, "of a print: light paths a cell; empty: 256, whose noise is as 1 % of a region",
                {.range = {1.0, 1e6}});
    command.add("--no-checker", a.no_checker, "no chart in the picture");
    command.add("--8-bits", a.job.eight_bits, "a PNG of 8-bit sRGB codes");
    add_geometry_options(command, a.job.photo);
    add_camera_options(command, a.job.photo, a.white_balance);
    add_dirt_options(command, a.job.photo);
    command.add("--lab-noise", a.job.lab_noise, "a table of a chart: standard deviation of L, a and b");
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
