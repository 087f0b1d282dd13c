// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/photo_options.h"
#include "cli/program/common_options.h"

namespace voxtone::cli {

namespace {

struct CalibratePhotoArguments {
    calibration::PhotoJob job;
    std::string coding = "auto", channels = "rgb";
    std::vector<double> corners, checker_corners;
    RunOptions run;
};

int run(CalibratePhotoArguments& a, const CalibrateJobs& jobs) {
    a.job.measure.coding = coding_of(a.coding);
    a.job.channels = a.channels == "wide" ? calibration::PhotoChannels::wide : calibration::PhotoChannels::rgb;
    a.job.measure.corners = four_points(a.corners);
    a.job.measure.checker_corners = four_points(a.checker_corners);
    return run_on_console(a.run, [&](Progress& progress) { return jobs.photo(a.job, progress); });
}

}  // namespace

Verb calibrate_photo_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibratePhotoArguments>();
    CalibratePhotoArguments& a = *arguments;
    Verb command("photo", "Measure the squares of a printed target in photographs of it beside a colour checker",
                 "front.tif turned.tif --target target/target.json -o patches.csv");
    command.add("photos", a.job.photos, "photographs: 16-bit TIFF or PNG, EXR, or RAW; several are averaged",
                {.unit = "FILE", .required = true});
    command.add("--target", a.job.target, "description of the target (target.json)",
                {.unit = "FILE", .required = true});
    add_out_option(command, a.job.out, "FILE", "patch table to write (.csv)");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--checker", a.job.checker, "chart beside the target: colorchecker24 or a file", {.unit = "NAME|FILE"});
    add_corners_option(command, "--corners", a.corners,
                       "corners of the slab in the picture, px: upper left, upper right, lower right, lower left");
    add_corners_option(command, "--checker-corners", a.checker_corners,
                       "corners of the checker's patches in the picture, px, in order round it");
    add_coding_option(command, a.coding);
    command.add("--channels", a.channels,
                "of a target's squares: rgb, linear sRGB cut at 0; wide, in which no ink is negative, and mixtures are "
                "predicted worse",
                {.choices = {"rgb", "wide"}});
    command.add("--inner", a.job.measure.inner, "part of a square's edge that is sampled", {.range = {0.1, 0.9}});
    command.add("--top", length(a.job.top_mm),
                "thickness of a target's squares as a gauge tells it, where they were polished; 30 um are 4 % of "
                "an extinction; empty: as printed");
    command.add("--overlay", a.job.overlay, "picture of what was sampled; empty: beside the table", {.unit = "FILE"});
    command.add("--picture", a.job.picture,
                "PNG of the target as it was measured, straightened: the --picture of `calibrate fit --report`",
                {.unit = "FILE.png"});
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
