// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/calibration/patches/patch_file.h"
#include "voxtone/calibration/photo/photo_simulation.h"
#include "voxtone/calibration/target/target_file.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/io/codecs/photograph_writer.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::cli {

namespace {

struct CalibrateSimulateArguments {
    calibration::PhotoOptions options;
    std::string target, resins = "vero-opaque", out, truth, checker = "colorchecker24";
    std::vector<double> white_balance{0.62, 1.0, 0.75};
    bool no_checker = false, eight_bits = false, ideal = false;
    int threads = 0;
    ConsoleOptions console;
};

CommandResult simulate(CalibrateSimulateArguments& a, Progress& progress) {
    const calibration::Target target = calibration::read_target(a.target);
    const optics::ResinSet set = io::find_resin_set(a.resins);
    a.options.checker = !a.no_checker;
    a.options.white_balance = {a.white_balance[0], a.white_balance[1], a.white_balance[2]};
    a.options.validate();
    progress.begin_stage("photograph", 0);
    const calibration::TargetColours colours = calibration::reflected_colours(
        target, set, a.ideal ? calibration::MixtureKind::ideal : calibration::MixtureKind::dithered);
    calibration::SimulatedPhoto photo =
        calibration::simulate_photo(target, colours, calibration::find_checker(a.checker), a.options);
    if (a.eight_bits) photo.photograph.bits = 8;
    io::write_whole_file(a.out, io::photograph_bytes(photo.photograph, a.out));
    if (!a.truth.empty()) {
        calibration::PatchTable table;
        for (std::size_t s = 0; s < target.squares.size(); ++s) {
            const calibration::TargetSquare& square = target.squares[s];
            const Eigen::Vector3d& rho = colours.squares[s];
            table.patches.push_back(
                {square.top, square.backing, target.top_mm, target.base_mm, {rho[0], rho[1], rho[2]}, {}, {}});
        }
        io::write_whole_file(a.truth,
                             calibration::patch_table_text(
                                 table, fmt::format("What the squares of {} reflect if made of {}: the truth behind {}",
                                                    a.target, set.name, a.out)));
    }
    progress.end_stage();
    const auto corners = [](const std::vector<Eigen::Vector2d>& points) {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const Eigen::Vector2d& p : points) list.push_back({p.x(), p.y()});
        return list;
    };
    const nlohmann::ordered_json json{{"format", "voxtone-calibrate-simulate"},
                                      {"version", 1},
                                      {"photograph", a.out},
                                      {"target_corners_px", corners(photo.target_corners_px)},
                                      {"checker_corners_px", corners(photo.checker_corners_px)}};
    return {json.dump(), fmt::format("{}: {} x {} pixels, {} of {}\n", a.out, photo.photograph.width_px,
                                     photo.photograph.height_px, a.target, set.name)};
}

}  // namespace

Command add_calibrate_simulate_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibrateSimulateArguments>();
    CalibrateSimulateArguments& a = *arguments;
    calibration::PhotoOptions& o = a.options;
    CLI::App* command = calibrate.add_subcommand(
        "simulate",
        "Draw the photograph that a target would give if printed with known resins: a rehearsal without a printer");
    command->add_option("target", a.target, "description of the target (target.json)")->type_name("FILE")->required();
    command->add_option("--resins", a.resins, "resin set (`voxtone list resins`) or file, RGB")
        ->type_name("SET|FILE")
        ->capture_default_str();
    command->add_option("-o,--out", a.out, "photograph to write: .png, .tif (16 bits, linear) or .exr")
        ->type_name("FILE")
        ->required();
    command->add_option("--truth", a.truth, "write what the squares truly reflect, as a patch table")
        ->type_name("FILE");
    command->add_option("--checker", a.checker, "chart beside the target: colorchecker24 or a file")
        ->type_name("NAME|FILE")
        ->capture_default_str();
    command->add_flag(
        "--ideal", a.ideal,
        "mixtures are ideal (fit them without --printer); else they are dithers of the printer's voxels, as they "
        "are printed");
    command->add_flag("--no-checker", a.no_checker, "no chart in the picture");
    command->add_flag("--8-bits", a.eight_bits, "a PNG of 8-bit sRGB codes");
    const auto number = [&](const char* name, auto& value, const char* help) {
        command->add_option(name, value, help)->capture_default_str();
    };
    number("--width", o.width_px, "pixels");
    number("--height", o.height_px, "pixels");
    number("--tilt-x", o.tilt_x_deg, "camera tilted, degrees");
    number("--tilt-y", o.tilt_y_deg, "camera tilted, degrees");
    number("--turn", o.turn_deg, "picture turned, degrees");
    number("--distance", o.distance, "of the camera, in widths of the scene");
    number("--lamp", o.lamp_mm, "distance of the lamp in mm, 0: far away");
    number("--lamp-azimuth", o.lamp_azimuth_deg, "where the lamp stands, degrees");
    number("--blur", o.blur_px, "standard deviation of the blur in pixels");
    number("--vignetting", o.vignetting, "light lost in the corners");
    number("--exposure", o.exposure, "1: a perfect white is at 80 % of full scale");
    command->add_option("--white-balance", a.white_balance, "gains of red, green, blue")
        ->delimiter(',')
        ->expected(3)
        ->capture_default_str();
    number("--matrix", o.matrix, "how much the camera mixes colours: 0 not at all, 1 as cameras do");
    number("--electrons", o.electrons, "at full scale: shot noise; 0: no noise");
    number("--read-noise", o.read_noise, "standard deviation, of full scale");
    number("--dust", o.dust, "specks");
    number("--scratches", o.scratches, "scratches");
    command->add_flag("--mirrored", o.mirrored, "as on a printer that mirrors");
    number("--checker-turns", o.checker_turns, "quarter turns of the chart");
    number("--checker-error", o.checker_error, "relative deviation of the chart's patches from what is known of them");
    number("--seed", o.seed, "seed of noise and dirt");
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console, [&](Progress& progress) { return simulate(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
