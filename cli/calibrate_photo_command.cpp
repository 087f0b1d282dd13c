// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/calibration/patches/patch_file.h"
#include "voxtone/calibration/photo/photo_measurement.h"
#include "voxtone/calibration/photo/photo_overlay.h"
#include "voxtone/calibration/target/target_file.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/io/files/whole_file.h"

namespace voxtone::cli {

namespace {

struct CalibratePhotoArguments {
    std::vector<std::string> photos;
    std::string target, checker = "colorchecker24", out, overlay, coding = "auto";
    std::vector<double> corners, checker_corners;
    double inner = 0.6;
    int threads = 0;
    ConsoleOptions console;
};

std::optional<std::array<Eigen::Vector2d, 4>> four_points(const std::vector<double>& numbers) {
    if (numbers.empty()) return std::nullopt;
    std::array<Eigen::Vector2d, 4> points;
    for (std::size_t i = 0; i < 4; ++i) points[i] = {numbers[2 * i], numbers[2 * i + 1]};
    return points;
}

std::string overlay_name(const CalibratePhotoArguments& a, std::size_t photo) {
    const std::filesystem::path base = a.overlay.empty()
                                           ? std::filesystem::path(a.out).replace_extension().concat("-overlay.png")
                                           : std::filesystem::path(a.overlay);
    if (photo == 0) return base.string();
    return std::filesystem::path(base).replace_extension().concat(fmt::format("-{}.png", photo + 1)).string();
}

CommandResult measure(const CalibratePhotoArguments& a, Progress& progress) {
    const calibration::Target target = calibration::read_target(a.target);
    const calibration::CheckerChart chart = calibration::find_checker(a.checker);
    if (a.photos.size() > 1 && !(a.corners.empty() && a.checker_corners.empty()))
        throw UsageError("corners given by hand are those of one photograph; measure such photographs one by one");
    calibration::PhotoMeasureOptions options;
    options.coding = a.coding == "linear" ? io::SampleCoding::linear
                     : a.coding == "srgb" ? io::SampleCoding::srgb
                                          : io::SampleCoding::unknown;
    options.inner = a.inner;
    options.corners = four_points(a.corners);
    options.checker_corners = four_points(a.checker_corners);

    progress.begin_stage("photographs", a.photos.size(), "photographs");
    std::vector<calibration::PhotoMeasurement> photos;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    std::string text;
    for (std::size_t p = 0; p < a.photos.size(); ++p) {
        progress.check_cancelled();
        photos.push_back(
            calibration::measure_photo(io::read_photograph(a.photos[p], &progress), target, chart, options));
        calibration::PhotoMeasurement& photo = photos.back();
        for (const std::string& warning : photo.warnings) progress.warn(warning);
        io::write_whole_file(overlay_name(a, p), io::png_bytes(calibration::photo_overlay(photo, chart)));
        list.push_back({{"photograph", a.photos[p]},
                        {"overlay", overlay_name(a, p)},
                        {"markers", photo.view.markers},
                        {"residual_px", photo.view.residual_px},
                        {"px_per_mm", photo.view.px_per_mm},
                        {"blur_mm", photo.view.blur_mm},
                        {"checker_residual", photo.model.chart_residual()},
                        {"frame_residual", photo.model.frame_residual()}});
        text += fmt::format(
            "{}: {} markers, {:.1f} px/mm, blur {:.2f} mm, checker off by {:.4f}, frame by {:.2f} %; drawn in {}\n",
            a.photos[p], photo.view.markers, photo.view.px_per_mm, photo.view.blur_mm, photo.model.chart_residual(),
            100 * photo.model.frame_residual(), overlay_name(a, p));
        photo.photograph.pixels = {};  // the figures are enough from here on
        progress.advance();
    }
    progress.end_stage();
    const calibration::MeasuredTable result = calibration::average_photos(photos, target);
    for (const std::string& warning : result.warnings) progress.warn(warning);
    std::string comment = fmt::format("rho(45 -> 0) of {} from {} photograph(s); standard errors beside the values.",
                                      a.target, photos.size());
    double worst_error = 0, worst_spread = 0;
    for (std::size_t s = 0; s < result.table.patches.size(); ++s) {
        Eigen::Vector3d spread = result.spread[s];
        if (photos.size() == 1)
            spread = photos[0].model.noise(photos[0].squares[s].middle_px, photos[0].squares[s].spread);
        comment += fmt::format("\n{}: spread {:.5f} {:.5f} {:.5f} {}", calibration::square_name(target, s), spread[0],
                               spread[1], spread[2], photos.size() == 1 ? "between its blocks" : "between photographs");
        for (const double error : result.table.patches[s].error) worst_error = std::max(worst_error, error);
        worst_spread = std::max(worst_spread, spread.maxCoeff());
    }
    io::write_whole_file(a.out, calibration::patch_table_text(result.table, comment));
    const nlohmann::ordered_json json{{"format", "voxtone-calibrate-photo"},
                                      {"version", 1},
                                      {"patches", a.out},
                                      {"count", result.table.patches.size()},
                                      {"worst_error", worst_error},
                                      {"worst_spread", worst_spread},
                                      {"photographs", list}};
    return {json.dump(), text + fmt::format("{}: {} patches, standard errors up to {:.4f}\n", a.out,
                                            result.table.patches.size(), worst_error)};
}

}  // namespace

Command add_calibrate_photo_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibratePhotoArguments>();
    CalibratePhotoArguments& a = *arguments;
    CLI::App* command = calibrate.add_subcommand(
        "photo", "Measure the squares of a printed target in photographs of it beside a colour checker");
    command->add_option("photos", a.photos, "photographs: 16-bit TIFF or PNG, EXR, or RAW; several are averaged")
        ->type_name("FILE")
        ->required();
    command->add_option("--target", a.target, "description of the target (target.json)")->type_name("FILE")->required();
    command->add_option("-o,--out", a.out, "patch table to write (.csv)")->type_name("FILE")->required();
    command->add_option("--checker", a.checker, "chart beside the target: colorchecker24 or a file")
        ->type_name("NAME|FILE")
        ->capture_default_str();
    command
        ->add_option("--corners", a.corners,
                     "corners of the slab in the picture, px: upper left, upper right, lower right, lower left")
        ->type_name("X,Y,...")
        ->delimiter(',')
        ->expected(8);
    command
        ->add_option("--checker-corners", a.checker_corners,
                     "corners of the checker's patches in the picture, px, in order round it")
        ->type_name("X,Y,...")
        ->delimiter(',')
        ->expected(8);
    command
        ->add_option("--coding", a.coding,
                     "how samples stand for light; auto: as the file says, else as the checker's greys say")
        ->check(CLI::IsMember({"auto", "linear", "srgb"}))
        ->capture_default_str();
    command->add_option("--inner", a.inner, "part of a square's edge that is sampled")
        ->check(CLI::Range(0.1, 0.9))
        ->capture_default_str();
    command->add_option("--overlay", a.overlay, "picture of what was sampled; empty: beside the table")
        ->type_name("FILE");
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console, [&](Progress& progress) { return measure(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
