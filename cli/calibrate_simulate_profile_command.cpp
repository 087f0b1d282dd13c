// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/calibration/profile/profile_simulation.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/io/codecs/photograph_writer.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/profile_file.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::cli {

namespace {

namespace fs = std::filesystem;

struct CalibrateSimulateProfileArguments {
    calibration::SpotCamera camera;
    std::string resins, role, thickness, out, spot = "0.06mm", blur = "0.05mm";
    std::vector<double> offset{3.3, -2.6};
    std::uint32_t paths = 1 << 18;
    int threads = 0;
    ConsoleOptions console;
};

void write_series(const calibration::SpotScene& scene, const std::string& name,
                  const CalibrateSimulateProfileArguments& a, Progress& progress) {
    progress.begin_stage(name, a.camera.seconds.size(), "exposures");
    for (std::size_t k = 0; k < a.camera.seconds.size(); ++k) {
        progress.check_cancelled();
        for (const bool lit : {true, false}) {
            const fs::path file = fs::path(a.out) / fmt::format("{}{}-{:02}.exr", name, lit ? "" : "-dark", k + 1);
            io::write_whole_file(file, io::photograph_bytes(scene.photograph(k, lit).photograph, file.string()));
        }
        progress.advance();
    }
    progress.end_stage();
}

CommandResult simulate(CalibrateSimulateProfileArguments& a, Progress& progress) {
    const optics::ResinSet set = io::find_resin_set(a.resins);
    const double thickness = parse_length_mm(a.thickness, "--thickness");
    a.camera.spot_mm = parse_length_mm(a.spot, "--spot");
    a.camera.blur_mm = parse_length_mm(a.blur, "--blur");
    a.camera.offset_px = {a.offset[0], a.offset[1]};
    a.camera.validate();
    const calibration::SlabProfiles slab =
        calibration::slab_profiles(set, a.role, thickness, a.camera.grid(), a.paths, a.camera.seed, &progress);
    std::error_code error;
    fs::create_directories(a.out, error);
    if (error) throw FileError(fmt::format("{}: cannot be made: {}", a.out, error.message()));

    const calibration::SpotScene R(slab.R, a.camera), T(slab.T, a.camera);
    write_series(R, "reflection", a, progress);
    write_series(T, "transmission", a, progress);
    constexpr double spacing_mm = 0.044;
    const auto samples = static_cast<std::size_t>(a.camera.size_px * a.camera.mm_per_px / 2 / spacing_mm);
    io::ProfileFile truth{fmt::format("{} {}", set.name, a.role),
                          "simulated: what the photographs were drawn from, seen through spot, blur and pixel",
                          {},
                          {}};
    for (std::size_t c = 0; c < 3; ++c)
        truth.by_channel.push_back({thickness, T.truth(c, spacing_mm, samples), R.truth(c, spacing_mm, samples)});
    const std::string truth_file = (fs::path(a.out) / "truth.json").string();
    io::write_whole_file(truth_file, io::profile_text(truth));
    const auto totals = [](const std::array<std::vector<double>, 3>& side) {
        return fmt::format("{:.6g},{:.6g},{:.6g}", side[0][0], side[1][0], side[2][0]);
    };
    const std::string next = fmt::format(
        "voxtone calibrate profile --reflection {0}/reflection-??.exr --reflection-dark {0}/reflection-dark-??.exr "
        "--reflectance "
        "{1} "
        "--transmission {0}/transmission-??.exr --transmission-dark {0}/transmission-dark-??.exr --transmittance {2} "
        "--thickness "
        "{3}mm "
        "--mm-per-px {4} -o profile.json",
        a.out, totals(slab.R), totals(slab.T), thickness, a.camera.mm_per_px);
    const nlohmann::ordered_json json{{"format", "voxtone-calibrate-simulate-profile"},
                                      {"version", 1},
                                      {"folder", a.out},
                                      {"truth", truth_file},
                                      {"centre_px", {R.centre_px().x(), R.centre_px().y()}},
                                      {"reflectance", {slab.R[0][0], slab.R[1][0], slab.R[2][0]}},
                                      {"transmittance", {slab.T[0][0], slab.T[1][0], slab.T[2][0]}},
                                      {"next", next}};
    return {json.dump(),
            fmt::format("{}: {} exposures of {} x {} pixels and as many dark frames of each side; the truth is in "
                        "{}\nMeasure them: {}\n",
                        a.out, a.camera.seconds.size(), a.camera.size_px, a.camera.size_px, truth_file, next)};
}

}  // namespace

Command add_calibrate_simulate_profile_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibrateSimulateProfileArguments>();
    CalibrateSimulateProfileArguments& a = *arguments;
    calibration::SpotCamera& o = a.camera;
    CLI::App* command = calibrate.add_subcommand("simulate-profile",
                                                 "Draw the photographs that `calibrate profile` measures, of a slab of "
                                                 "a known resin: a rehearsal without a laboratory");
    command->add_option("resins", a.resins, "resin set (`voxtone list resins`) or file, RGB")
        ->type_name("SET|FILE")
        ->required();
    command->add_option("role", a.role, "resin of the slab: W, K, ...")->type_name("ROLE")->required();
    command->add_option("--thickness", a.thickness, "of the slab: 3mm")->type_name("LENGTH")->required();
    command
        ->add_option("-o,--out", a.out,
                     "folder for reflection-NN.exr, transmission-NN.exr, their -dark-NN.exr, truth.json")
        ->type_name("FOLDER")
        ->required();
    const auto number = [&](const char* name, auto& value, const char* help) {
        command->add_option(name, value, help)->capture_default_str();
    };
    command->add_option("--exposures", o.seconds, "exposure times, seconds, rising")
        ->type_name("S,S,...")
        ->delimiter(',')
        ->capture_default_str();
    number("--size", o.size_px, "edge of the square pictures, pixels");
    number("--mm-per-px", o.mm_per_px, "width of a pixel on the slab, mm");
    command->add_option("--offset", a.offset, "of the spot from the picture's middle, pixels right and down")
        ->type_name("X,Y")
        ->delimiter(',')
        ->expected(2)
        ->capture_default_str();
    command->add_option("--spot", a.spot, "radius of the projected pixel and the pinhole")
        ->type_name("LENGTH")
        ->capture_default_str();
    command->add_option("--blur", a.blur, "standard deviation of the camera's blur")
        ->type_name("LENGTH")
        ->capture_default_str();
    number("--stretch", o.stretch, "width of the spot over its height; 1: a camera straight above");
    number("--stray", o.stray, "stray light, part of the light in the middle of the spot");
    number("--peak", o.peak, "brightest pixel at the shortest exposure, part of full scale");
    number("--full-well", o.full_well, "electrons at full scale; 0: no noise");
    number("--read-noise", o.read_noise, "standard deviation, part of full scale");
    number("--black", o.black, "what the camera writes without light, part of full scale");
    number("--bits", o.bits, "of a sample");
    number("--paths", a.paths, "traced per channel");
    number("--seed", o.seed, "seed of paths and noise");
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console, [&](Progress& progress) { return simulate(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
