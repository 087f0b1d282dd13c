// SPDX-License-Identifier: GPL-3.0-or-later
//
// The only place that knows both how a print is predicted (slicer) and how its photograph is read (calibration).
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/units.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/photo_options.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"
#include "slicer/predict/top_print.h"

namespace voxtone::cli {

namespace {

struct CompareArguments {
    calibration::CompareJob job;
    slicer::PredictOptions predict;
    std::vector<std::string> files;  ///< photographs, and last the stack
    std::string coding = "auto";
    std::vector<double> corners, checker_corners;
    RunOptions run;
};

calibration::PredictedPrint predicted_print(const CompareArguments& a, Progress& progress) {
    slicer::TopPrint top = slicer::predict_top_print(a.predict, progress);
    calibration::PredictedPrint print;
    print.name = a.job.stack;
    print.model = a.predict.model;
    print.columns = top.columns, print.rows = top.rows;
    print.cell_mm = {top.cell_mm[0], top.cell_mm[1]};
    print.rgb = std::move(top.rgb);
    print.resins = std::move(top.resins);
    print.by_extinction = std::move(top.by_extinction);
    print.seen = slicer::eye_over(top, a.job.viewing_distance_mm);
    return print;
}

int run(CompareArguments& a, const CalibrateJobs& jobs) {
    a.job.photos.assign(a.files.begin(), a.files.end() - 1);
    a.job.stack = a.predict.stack = a.files.back();
    a.job.read.coding = coding_of(a.coding);
    a.job.read.corners = four_points(a.corners);
    a.job.read.checker_corners = four_points(a.checker_corners);
    a.predict.threads = a.run.threads;
    return run_on_console(a.run, [&](Progress& progress) {
        return jobs.compare(
            a.job, [&](Progress& to) { return predicted_print(a, to); }, progress);
    });
}

void add_photo_options(CLI::App& command, CompareArguments& a) {
    add_corners_option(command, "--corners", a.corners,
                       "corners of the print in the picture, px, in order round it, where they are not found");
    add_value(command, "--checker", a.job.checker,
              "chart beside the print, which makes colours of the camera's: none, colorchecker24 or a file")
        ->type_name("NAME|FILE");
    add_corners_option(command, "--checker-corners", a.checker_corners,
                       "corners of the checker's patches in the picture, px, in order round it");
    add_coding_option(command, a.coding);
}

void add_prediction_options(CLI::App& command, CompareArguments& a) {
    add_value(command, "--predict", a.predict.model, "by which model [transport|monte-carlo]")
        ->check(CLI::IsMember({"transport", "monte-carlo"}));
    a.run.lengths.add(command, "--cell", a.predict.cell_mm, "what is compared as one: edge of the cells");
    add_count(command, "--spp", a.predict.quality.paths, "monte-carlo: paths per cell and channel");
    add_value(command, "--backing", a.predict.backing,
              "what lay under the print [auto|black|white|none]; auto: what the job said, else black")
        ->check(CLI::IsMember({"auto", "black", "white", "none"}));
    add_resins_option(command, a.predict.resins, "; empty: that of the job");
    a.run.lengths.add(command, "--viewing-distance", a.job.viewing_distance_mm,
                      "from which an eye looks: what it does not resolve does not count");
}

}  // namespace

Command add_compare_command(CLI::App& program, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CompareArguments>();
    CompareArguments& a = *arguments;
    CLI::App* command = program.add_subcommand(
        "compare", "Hold photographs of a flat print against what its stack was predicted to look like");
    command
        ->add_option("files", a.files,
                     "photographs of the print (PNG, JPEG, TIFF, EXR, RAW) with ground of one colour around it, and "
                     "last the stack: the output folder of `slice`")
        ->type_name("PHOTO... OUT")
        ->expected(2, 1000)
        ->required();
    add_out_option(*command, a.job.out, "FOLDER", "folder for compare.html and compare.json");
    add_overwrite_option(*command, a.job.overwrite);
    add_photo_options(*command, a);
    add_prediction_options(*command, a);
    add_run_options(*command, a.run);
    add_example(*command, "photograph.jpg out/photo -o compared");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

}  // namespace voxtone::cli
