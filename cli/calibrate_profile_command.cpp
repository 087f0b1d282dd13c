// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/calibration/profile/profile_measurement.h"
#include "voxtone/calibration/profile/profile_plot.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/profile_file.h"

namespace voxtone::cli {

namespace {

struct SideArguments {
    std::vector<std::string> lit, dark;
    std::vector<double> total;
    [[nodiscard]] bool given() const { return !lit.empty() || !dark.empty() || !total.empty(); }
};

struct CalibrateProfileArguments {
    SideArguments R, T;
    calibration::ProfileMeasureOptions options;
    std::vector<double> mm_per_px;
    std::string thickness, name, out, plot, spacing = "0.044mm", reach = "0", spot;
    int threads = 0;
    ConsoleOptions console;
};

calibration::ExposureSeries series(const SideArguments& side, const std::string& name, const char* total) {
    calibration::ExposureSeries result;
    result.name = name;
    if (side.total.size() != 3)
        throw UsageError(fmt::format("{} is missing: the measured albedo of red, green and blue", total));
    result.total = {side.total[0], side.total[1], side.total[2]};
    for (const std::string& file : side.lit) result.lit.push_back(calibration::parse_exposure(file));
    for (const std::string& file : side.dark) result.dark.push_back(calibration::parse_exposure(file));
    return result;
}

nlohmann::ordered_json side_json(const calibration::MeasuredSide& side) {
    nlohmann::ordered_json channels = nlohmann::ordered_json::array();
    for (const calibration::RadialProfile& p : side.profile)
        channels.push_back({{"noise", p.noise},
                            {"asymmetry", p.asymmetry},
                            {"scale_error", p.scale_error},
                            {"missing_px", p.missing}});
    return {{"centre_px", {side.centre.px.x(), side.centre.px.y()}},
            {"centre_error_px", {side.centre.error_px.x(), side.centre.error_px.y()}},
            {"samples", side.profile[0].light.size()},
            {"seconds", side.seconds},
            {"step", side.step},
            {"pixels_by_longest_exposure", side.pixels},
            {"tail", side.tail},
            {"channels", channels}};
}

std::string side_text(const calibration::MeasuredSide& side, const char* name) {
    const std::size_t samples = side.profile[0].light.size();
    std::string text = fmt::format("{}: centre ({:.3f}, {:.3f}) px, to {:.4f} px; {} samples to {:.2f} mm\n", name,
                                   side.centre.px.x(), side.centre.px.y(), side.centre.error_px.maxCoeff(), samples,
                                   static_cast<double>(samples - 1) * side.spacing_mm);
    text += "  longest exposure that counts, pixels:";
    for (std::size_t k = 0; k < side.seconds.size(); ++k)
        text += fmt::format(" {} {}{}", calibration::seconds_text(side.seconds[k]), side.pixels[k + 1],
                            k + 1 < side.seconds.size() ? "," : "\n");
    constexpr const char* names[] = {"red", "green", "blue"};
    for (std::size_t c = 0; c < 3; ++c)
        text +=
            fmt::format("  {:<5} noise {:.2f} times the camera's, not round {:.2f} %, scale to {:.2f} %\n", names[c],
                        side.profile[c].noise, 100 * side.profile[c].asymmetry, 100 * side.profile[c].scale_error);
    return text;
}

CommandResult measure(CalibrateProfileArguments& a, Progress& progress) {
    const bool layer = a.T.given();
    if (!a.R.given())
        throw UsageError("--reflection is missing: photographs of the lit point from the side of the light");
    if (layer == a.thickness.empty())
        throw UsageError(
            "a layer has --transmission and --thickness, a target (what is wanted of a surface) has neither; one is "
            "given");
    if (a.mm_per_px.empty()) throw UsageError("--mm-per-px is missing");
    a.options.spacing_mm = parse_length_mm(a.spacing, "--spacing");
    a.options.reach_mm = parse_length_mm(a.reach, "--reach");
    a.options.mm_per_px = a.mm_per_px[0];
    io::ProfileFile file;
    file.name = a.name.empty() ? std::filesystem::path(a.out).stem().string() : a.name;
    file.source = fmt::format("measured from {} exposures", a.R.lit.size() + a.T.lit.size());
    const double thickness = layer ? parse_length_mm(a.thickness, "--thickness") : 0;
    if (layer && !(thickness > 0)) throw UsageError(fmt::format("--thickness is {} mm; it must be above 0", thickness));

    const calibration::ExposureSeries R_series = series(a.R, "reflection", "--reflectance");
    const calibration::ExposureSeries T_series =
        layer ? series(a.T, "transmission", "--transmittance") : calibration::ExposureSeries{};
    if (layer) calibration::expect_no_light_made(R_series.total, T_series.total);

    nlohmann::ordered_json json{{"format", "voxtone-calibrate-profile"}, {"version", 1}, {"profile", a.out}};
    progress.begin_stage("reflection", 0);
    const calibration::MeasuredSide R = measure_side(R_series, a.options, &progress);
    progress.end_stage();
    json["R"] = side_json(R);
    std::string text = side_text(R, "reflection");
    for (const std::string& warning : R.warnings) progress.warn(warning);
    for (std::size_t c = 0; c < 3; ++c) file.by_channel.push_back({thickness, {}, R.samples(c)});
    if (layer) {
        a.options.mm_per_px = a.mm_per_px.back();
        progress.begin_stage("transmission", 0);
        const calibration::MeasuredSide T = measure_side(T_series, a.options, &progress);
        progress.end_stage();
        json["T"] = side_json(T);
        text += side_text(T, "transmission");
        for (const std::string& warning : T.warnings) progress.warn(warning);
        for (std::size_t c = 0; c < 3; ++c) file.by_channel[c].T = T.samples(c);
    }
    if (!a.spot.empty()) {
        const double k = calibration::blurred_from(parse_length_mm(a.spot, "--spot"), 0.1);
        json["blurred_from_per_mm"] = k;
        text += fmt::format(
            "The spot lowers coefficients above {:.2f} cycles per mm (waves shorter than {:.3f} mm) by more than 10 "
            "%\n",
            k, 1 / k);
    }
    const std::string plot = a.plot.empty() ? std::filesystem::path(a.out).replace_extension(".svg").string() : a.plot;
    io::write_whole_file(a.out, io::profile_text(file));
    io::write_whole_file(plot, calibration::profile_plot(file));
    json["plot"] = plot;
    return {json.dump(), text + fmt::format("Wrote {}, drawn in {}\n", a.out, plot)};
}

}  // namespace

Command add_calibrate_profile_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibrateProfileArguments>();
    CalibrateProfileArguments& a = *arguments;
    calibration::ProfileMeasureOptions& o = a.options;
    CLI::App* command = calibrate.add_subcommand(
        "profile",
        "Measure how light spreads in a slab: photographs of a lit point become a scattering profile.\n"
        "Each series runs from short to long and has a dark frame (projector black, pinhole covered) of the same time "
        "for every\n"
        "exposure. How long they are is read from the files (EXIF), or given as FILE@SECONDS: spot.tif@0.5, "
        "spot.tif@1/15.");
    const auto photographs = [&](const char* name, std::vector<std::string>& files, const char* help) {
        return command->add_option(name, files, help)->type_name("FILE[@SECONDS]");
    };
    const auto albedo = [&](const char* name, std::vector<double>& values, const char* help) {
        command->add_option(name, values, help)->type_name("R,G,B")->delimiter(',')->expected(3);
    };
    photographs("--reflection", a.R.lit, "photographs of a projected pixel: RAW, or linear 16-bit TIFF, PNG or EXR")
        ->required();
    photographs("--reflection-dark", a.R.dark, "the same with the projector black")->required();
    albedo("--reflectance", a.R.total, "measured share of light that the slab reflects, above 0 to 1");
    photographs("--transmission", a.T.lit,
                "photographs of the slab upon a pinhole; without: the file is a target for stacks to reach");
    photographs("--transmission-dark", a.T.dark, "the same with the pinhole covered");
    albedo("--transmittance", a.T.total, "measured share of light that the slab transmits, above 0 to 1");
    command->add_option("--thickness", a.thickness, "of the slab: 3mm")->type_name("LENGTH");
    command
        ->add_option("--mm-per-px", a.mm_per_px,
                     "width of a pixel on the slab, mm; two numbers: reflection, transmission")
        ->type_name("MM")
        ->delimiter(',')
        ->expected(1, 2)
        ->required();
    command->add_option("-o,--out", a.out, "profile to write (.json)")->type_name("FILE")->required();
    command->add_option("--plot", a.plot, "picture of the profile with its errors; empty: beside it, as NAME.svg")
        ->type_name("FILE.svg");
    command->add_option("--name", a.name, "name of the material; empty: that of the file");
    command->add_option("--spacing", a.spacing, "of samples")->type_name("LENGTH")->capture_default_str();
    command->add_option("--reach", a.reach, "distance of the last sample; 0: to the nearest border of the picture")
        ->type_name("LENGTH")
        ->capture_default_str();
    command->add_option("--spot", a.spot, "radius of the projected pixel or pinhole: prints which waves it blurs")
        ->type_name("LENGTH");
    const auto number = [&](const char* name, double& value, const char* help) {
        command->add_option(name, value, help)->group("Camera")->capture_default_str();
    };
    number("--full-well", o.noise.full_well, "electrons at full scale; for the weights of exposures");
    number("--read-noise", o.noise.read_noise, "standard deviation, part of full scale; for the weights of exposures");
    number("--saturation", o.noise.saturation, "samples from here on are left out, part of full scale");
    number("--most-asymmetry", o.most_asymmetry, "how far a spot may be from round, part of its light");
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console, [&](Progress& progress) { return measure(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
