// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"

namespace voxtone::cli {

namespace {

struct CalibrateResponsesArguments {
    calibration::ResponseSweepJob job;
    std::vector<std::string> card, card_dark;
    std::vector<double> corner{0, 0};
    std::vector<std::uint32_t> points;
    RunOptions run;
};

int run(CalibrateResponsesArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        for (const std::string& file : a.card) a.job.card.lit.push_back(jobs.exposure(file));
        for (const std::string& file : a.card_dark) a.job.card.dark.push_back(jobs.exposure(file));
        a.job.geometry.corner_px = {a.corner[0], a.corner[1]};
        a.job.geometry.points = {a.points[0], a.points[1]};
        return jobs.responses(a.job, progress);
    });
}

}  // namespace

Verb calibrate_responses_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateResponsesArguments>();
    CalibrateResponsesArguments& a = *arguments;
    Verb command(
        "responses",
        "Measure how light spreads from each cell of a surface: photographs of a projected square, moved from cell to "
        "cell, become the data set that `laminate factor` takes",
        "frames.csv --card card.tif --card-dark card-dark.tif --mm-per-px 0.05 --points 16,16 --pitch 0.5mm -o "
        "jade.bssrdf");
    command.add("frames", a.job.frames,
                "table file,dark,x_mm,y_mm: photograph, its dark frame, the square's middle from the surface's upper "
                "left corner; several rows of a place are its exposures, from short to long",
                {.unit = "FILE", .required = true});
    command.add("--card", a.card, "a grey card lit by the same square, from short to long",
                {.unit = "FILE[@SECONDS]", .required = true});
    command.add("--card-dark", a.card_dark, "its dark frames", {.unit = "FILE[@SECONDS]", .required = true});
    command.add("--card-albedo", a.job.card_albedo, "share of light that the card reflects, in all channels");
    command.add("--mm-per-px", a.job.geometry.mm_per_px, "width of a pixel on the surface, mm",
                {.unit = "MM", .required = true});
    command.add("--corner", a.corner, "of the surface in the pictures, upper left, pixels",
                {.unit = "X,Y", .separator = ',', .count = {2, 2}});
    command.add("--points", a.points, "cells along x and y",
                {.unit = "X,Y", .required = true, .separator = ',', .count = {2, 2}});
    command.add("--pitch", length(a.job.geometry.pitch_mm), "width of a cell and of the square", {.required = true});
    command.add("--radius", a.job.geometry.radius, "of the window that is kept, cells");
    command.add("--full-well", a.job.noise.full_well, "electrons at full scale", {.group = "Camera"});
    command.add("--saturation", a.job.noise.saturation, "samples from here on are left out, part of full scale",
                {.group = "Camera"});
    add_out_option(command, a.job.out, "FILE", "data set to write (.bssrdf)");
    add_overwrite_option(command, a.job.overwrite);
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
