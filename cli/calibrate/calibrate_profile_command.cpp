// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"

namespace voxtone::cli {

namespace {

struct SideArguments {
    std::vector<std::string> lit, dark;
    std::vector<double> total;
};

struct CalibrateProfileArguments {
    calibration::ProfileJob job;
    SideArguments R, T;
    std::vector<double> mm_per_px;
    std::vector<std::string> card, card_dark, lcd, lcd_dark;
    std::vector<std::uint32_t> slab_at, card_at, lcd_at;
    std::vector<double> card_albedo{0.18};
    RunOptions run;
};

std::vector<calibration::ExposureFile> exposures(const std::vector<std::string>& files, const CalibrateJobs& jobs) {
    std::vector<calibration::ExposureFile> parsed;
    for (const std::string& file : files) parsed.push_back(jobs.exposure(file));
    return parsed;
}

calibration::ProfileSide side_of(const SideArguments& side, double mm_per_px, const CalibrateJobs& jobs) {
    calibration::ProfileSide parsed{exposures(side.lit, jobs), exposures(side.dark, jobs), {}, mm_per_px};
    if (!side.total.empty()) parsed.total = {side.total[0], side.total[1], side.total[2]};
    return parsed;
}

calibration::PixelBox box_of(const std::vector<std::uint32_t>& at, const char* option) {
    if (at.size() != 4)
        throw UsageError(std::string(option) +
                         " is missing: X,Y,WIDTH,HEIGHT, the pixels to average, from the upper left corner");
    return {at[0], at[1], at[2], at[3]};
}

/// Photographs in even light, each with its dark frame.
void take_albedos(CalibrateProfileArguments& a, const CalibrateJobs& jobs) {
    if (!a.card.empty()) {
        const std::vector<double>& albedo = a.card_albedo;
        if (albedo.size() == 2) throw UsageError("--card-albedo: one number, or three for red, green and blue");
        a.job.card = {jobs.exposure(a.card[0]),
                      jobs.exposure(a.card_dark[0]),
                      box_of(a.slab_at, "--slab-at"),
                      box_of(a.card_at, "--card-at"),
                      {albedo[0], albedo[albedo.size() / 2], albedo.back()}};
    }
    if (!a.lcd.empty()) {
        a.job.lcd = {jobs.exposure(a.lcd[0]), jobs.exposure(a.lcd[1]), jobs.exposure(a.lcd_dark.front()),
                     jobs.exposure(a.lcd_dark.back()), box_of(a.lcd_at, "--lcd-at")};
    }
}

int run(CalibrateProfileArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        take_albedos(a, jobs);
        a.job.reflection = side_of(a.R, a.mm_per_px.front(), jobs);
        a.job.transmission = side_of(a.T, a.mm_per_px.back(), jobs);
        return jobs.profile(a.job, progress);
    });
}

void add_side_options(Verb& command, CalibrateProfileArguments& a) {
    const auto photographs = [&](const char* name, std::vector<std::string>& files, const char* help, bool required) {
        command.add(name, files, help, {.unit = "FILE[@SECONDS]", .required = required});
    };
    const auto albedo = [&](const char* name, std::vector<double>& values, const char* help) {
        command.add(name, values, help, {.unit = "R,G,B", .separator = ',', .count = {3, 3}});
    };
    photographs("--reflection", a.R.lit, "photographs of a projected pixel: RAW, or linear 16-bit TIFF, PNG or EXR",
                true);
    photographs("--reflection-dark", a.R.dark, "the same with the projector black", true);
    albedo("--reflectance", a.R.total, "measured share of light that the slab reflects, above 0 to 1");
    photographs("--transmission", a.T.lit,
                "photographs of the slab upon a pinhole; without: the file is a target for stacks to reach", false);
    photographs("--transmission-dark", a.T.dark, "the same with the pinhole covered", false);
    albedo("--transmittance", a.T.total, "measured share of light that the slab transmits, above 0 to 1");
    command.add("--thickness", length(a.job.thickness_mm), "of the slab: 3mm");
    command.add("--mm-per-px", a.mm_per_px, "width of a pixel on the slab, mm; two numbers: reflection, transmission",
                {.unit = "MM", .required = true, .separator = ',', .count = {1, 2}});
}

void add_albedo_options(Verb& command, CalibrateProfileArguments& a) {
    const auto photographs = [&](const char* name, std::vector<std::string>& files, const char* help, int least,
                                 int most, const char* needs) {
        command.add(name, files, help,
                    {.unit = "FILE[@SECONDS]", .count = {least, most}, .needs = needs, .group = "Even light"});
    };
    const auto box = [&](const char* name, std::vector<std::uint32_t>& at, const char* help) {
        command.add(name, at, help, {.unit = "X,Y,W,H", .separator = ',', .count = {4, 4}, .group = "Even light"});
    };
    photographs("--card", a.card, "instead of --reflectance: the slab on black cloth beside a grey card", 1, 1,
                "--card-dark");
    photographs("--card-dark", a.card_dark, "its dark frame", 1, 1, "--card");
    box("--slab-at", a.slab_at, "pixels of the slab in it, from the upper left corner");
    box("--card-at", a.card_at, "pixels of the card");
    command.add("--card-albedo", a.card_albedo, "of the card, one number or R,G,B",
                {.separator = ',', .count = {1, 3}, .group = "Even light"});
    photographs("--lcd", a.lcd,
                "instead of --transmittance: the slab upon a white screen under a diffuser, and the "
                "screen under the diffuser alone",
                2, 2, "--lcd-dark");
    photographs("--lcd-dark", a.lcd_dark, "their dark frames; one, where both were exposed alike", 1, 2, "--lcd");
    box("--lcd-at", a.lcd_at, "pixels of the slab, and of the screen where it lay");
}

void add_camera_options(Verb& command, calibration::ProfileMeasureOptions& measure) {
    const auto number = [&](const char* name, double& value, const char* help) {
        command.add(name, value, help, {.group = "Camera"});
    };
    number("--full-well", measure.noise.full_well, "electrons at full scale; for the weights of exposures");
    number("--read-noise", measure.noise.read_noise,
           "standard deviation, part of full scale; for the weights of exposures");
    number("--saturation", measure.noise.saturation, "samples from here on are left out, part of full scale");
    number("--most-asymmetry", measure.most_asymmetry, "how far a spot may be from round, part of its light");
}

}  // namespace

Verb calibrate_profile_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateProfileArguments>();
    CalibrateProfileArguments& a = *arguments;
    Verb command(
        "profile",
        "Measure how light spreads in a slab: photographs of a lit point become a scattering profile.\n"
        "Each series runs from short to long and has a dark frame (projector black, pinhole covered) of the same time "
        "for every exposure. How long they are is read from the files (EXIF), or given as FILE@SECONDS: spot.tif@0.5, "
        "spot.tif@1/15.",
        "--reflection r-01.tif r-02.tif --reflection-dark rd-01.tif rd-02.tif --reflectance 0.87,0.91,0.91 "
        "--mm-per-px 0.04 -o white.json");
    add_side_options(command, a);
    add_albedo_options(command, a);
    add_out_option(command, a.job.out, "FILE", "profile to write (.json)");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--plot", a.job.plot, "picture of the profile with its errors; empty: beside it, as NAME.svg",
                {.unit = "FILE.svg"});
    command.add("--name", a.job.name, "name of the material; empty: that of the file");
    command.add("--spacing", length(a.job.measure.spacing_mm), "of samples");
    command.add("--reach", length(a.job.measure.reach_mm),
                "distance of the last sample; 0: to the nearest border of the picture");
    command.add("--spot", length(a.job.spot_mm),
                "radius of the projected pixel or pinhole: prints which waves it blurs");
    add_camera_options(command, a.job.measure);
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
