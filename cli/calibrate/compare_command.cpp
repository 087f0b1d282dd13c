// SPDX-License-Identifier: GPL-3.0-or-later
//
// The only place that knows both how a print is predicted (slicer) and how its photograph is read (calibration).
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/units.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/photo_options.h"
#include "cli/program/common_options.h"
#include "io/profiles/lamp_file.h"
#include "slicer/predict/top_print.h"
#include "slicer/proof/proof_camera.h"

namespace voxtone::cli {

namespace {

struct CompareArguments {
    calibration::CompareJob job;
    slicer::PredictOptions predict;
    slicer::ProofOptions camera;     ///< before a body
    std::vector<std::string> files;  ///< photographs, and last the stack
    std::string coding = "auto";
    std::vector<double> corners, checker_corners;
    RunOptions run;
};

/// For page and messages.
std::string name_under(const std::string& stack, const std::string& illuminant) {
    return illuminant == io::usual_lamp ? stack : fmt::format("{} under {}", stack, illuminant);
}

calibration::PredictedPrint flat_print(const CompareArguments& a, slicer::TopPrint top) {
    calibration::PredictedPrint print;
    print.name = name_under(a.job.stack, top.illuminant);
    print.model = a.predict.model;
    print.illuminant = top.illuminant;
    print.columns = top.columns, print.rows = top.rows;
    print.cell_mm = {top.cell_mm[0], top.cell_mm[1]};
    print.rgb = std::move(top.rgb);
    print.by_paths = std::move(top.by_paths);
    print.set = top.set;
    print.response = {.columns = top.response.columns,
                      .rows = top.response.rows,
                      .channels = top.response.channels,
                      .resins = top.response.resins,
                      .value = std::move(top.response.value),
                      .by_extinction = std::move(top.response.by_extinction),
                      .by_absorption = std::move(top.response.by_absorption)};
    print.seen = slicer::eye_over(top, a.job.viewing_distance_mm);
    return print;
}

calibration::PredictedBody body_before(const CompareArguments& a, slicer::BodyPrint made) {
    const auto print = std::make_shared<const slicer::BodyPrint>(std::move(made));
    calibration::PredictedBody body;
    body.name = name_under(a.job.stack, print->illuminant);
    body.model = a.predict.model;
    body.illuminant = print->illuminant;
    body.position = print->mesh.positions_mm;
    body.normal = print->normals;
    body.rgb = print->mesh.rgb;
    body.triangles = print->mesh.triangles;
    body.cell_mm = print->cell_mm;
    body.set = print->set;
    const auto from = [print](const slicer::ProofOptions& camera) {
        return [print, camera](int width_px, int height_px) {
            return slicer::camera_before(camera, {slicer::vector_of(print->low_mm), slicer::vector_of(print->high_mm)},
                                         width_px, height_px);
        };
    };
    body.start = from(a.camera);
    for (const std::string& view : names_of<slicer::ProofView>()) {
        slicer::ProofOptions camera = a.camera;
        camera.view = view;
        body.other_sides.push_back({view, from(camera)});
    }
    body.sees_sky = [print](std::span<const std::uint32_t> places, std::span<const Eigen::Vector3d> directions) {
        return print->sees_sky(places, directions);
    };
    body.eye = [distance = a.job.viewing_distance_mm](int columns, int rows, const Eigen::Vector2d& cell_mm) {
        return slicer::eye_over(columns, rows, {cell_mm.x(), cell_mm.y()}, distance);
    };
    return body;
}

void expect_no_camera(const CompareArguments& a) {
    const slicer::ProofOptions usual;
    const char* given = a.camera.view != usual.view           ? "--view"
                        : a.camera.up != usual.up             ? "--up"
                        : a.camera.turn_deg != usual.turn_deg ? "--turn"
                        : a.camera.focal_mm != usual.focal_mm ? "--focal"
                                                              : nullptr;
    if (given)
        throw UsageError(fmt::format(
            "{}: would be ignored: {} is flat, and a flat print's place is found by its corners; leave it out", given,
            a.job.stack));
}

std::variant<calibration::PredictedPrint, calibration::PredictedBody> predicted_print(const CompareArguments& a,
                                                                                      Progress& progress) {
    auto print = slicer::predict_photographed(
        a.predict, a.job.refit ? slicer::ResinParts::extinction_and_absorption : slicer::ResinParts::extinction,
        progress);
    if (auto* top = std::get_if<slicer::TopPrint>(&print)) {
        expect_no_camera(a);
        if (a.job.refit && top->illuminant != io::usual_lamp)
            throw UsageError(
                fmt::format("--refit: {} is looked at under {}, and resins are fitted to colours under {}: take the "
                            "photograph under "
                            "daylight and give --illuminant {}, or leave --refit out",
                            a.job.stack, top->illuminant, io::usual_lamp, io::usual_lamp));
        return flat_print(a, std::move(*top));
    }
    return body_before(a, std::move(std::get<slicer::BodyPrint>(print)));
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

void add_photo_options(Verb& command, CompareArguments& a) {
    add_corners_option(command, "--corners", a.corners,
                       "corners of the print in the picture, px, in order round it, where they are not found");
    command.add("--checker", a.job.checker,
                "chart beside the print, which makes colours of the camera's: none, colorchecker24 or a file",
                {.unit = "NAME|FILE"});
    add_corners_option(command, "--checker-corners", a.checker_corners,
                       "corners of the checker's patches in the picture, px, in order round it");
    add_coding_option(command, a.coding);
}

/// As `proof` has them.
void add_camera_options(Verb& command, slicer::ProofOptions& o) {
    std::vector<std::string> views = names_of<slicer::ProofView>();
    views.insert(views.begin(), "auto");
    command.add("--view", o.view, "of a body: the side that is seen, within some 20 degrees; auto: three-quarter",
                {.choices = std::move(views)});
    command.add("--up", o.up, "of a body: which way of the model as printed is up in the picture",
                {.choices = {"z", "-z", "y", "-y", "x", "-x"}});
    command.add("--turn", o.turn_deg, "of a body: turns it first, degrees, counter-clockwise from above",
                {.unit = "DEG"});
    command.add("--focal", o.focal_mm, "of a body: focal length, mm, for a frame of 36 mm, about", {.unit = "MM"});
}

void add_prediction_options(Verb& command, CompareArguments& a) {
    command.add("--predict", a.predict.model, "by which model", {.choices = {"transport", "monte-carlo"}});
    command.add("--cell", length(a.predict.cell_mm), "what is compared as one: edge of the cells");
    command.add("--spp", a.predict.quality.paths, "monte-carlo: paths per cell and channel");
    command.add("--backing", a.predict.backing,
                "what lay under the print, as `slice` is told; auto: what the job said, else black");
    add_resins_option(command, a.predict.resins, "; empty: that of the job");
    add_illuminant_option(command, a.predict.illuminant);
    command.add("--viewing-distance", length(a.job.viewing_distance_mm),
                "from which an eye looks: what it does not resolve does not count");
}

}  // namespace

Verb compare_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CompareArguments>();
    CompareArguments& a = *arguments;
    Verb command("compare", "Hold photographs of a print against what its stack was predicted to look like",
                 "photograph.jpg out/photo -o compared");
    command.add("files", a.files,
                "photographs of the print (PNG, JPEG, TIFF, EXR, RAW) with ground of one colour around it, and "
                "last the stack: the output folder of `slice`",
                {.unit = "PHOTO... OUT", .required = true, .count = {2, 1000}});
    add_out_option(command, a.job.out, "FOLDER", "folder for compare.html and compare.json");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--refit", a.job.refit,
                "leave regions.json there too, by which `calibrate fit` makes the resins' set better");
    add_photo_options(command, a);
    add_camera_options(command, a.camera);
    add_prediction_options(command, a);
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
