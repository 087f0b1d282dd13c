// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/chart_options.h"

namespace voxtone::cli {

namespace {

struct CalibrateIccArguments {
    calibration::IccJob job;
    std::string intent = "absolute";
    ChartOptions chart;
    RunOptions run;
};

int run(CalibrateIccArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        set_chart_fit(a.chart, a.job.fit.chart);
        if (a.intent == "relative") a.job.options.white = calibration::ProfileWhite::medium;
        return jobs.icc(a.job, progress);
    });
}

void add_profile_options(Verb& command, CalibrateIccArguments& a) {
    calibration::IccChartOptions& options = a.job.options;
    command.add("--channels-are", options.channels_are,
                "resin of each channel, in order: C,M,Y,K; empty: those of CMYK or CMY",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--rest", options.rest, "resin of what the channels leave", {.unit = "ROLE"});
    command.add("--patches", options.patches,
                "mixtures to take from the profile's table; its measurements, where it carries them, go before");
    command.add("--intent", a.intent,
                "colours relative to a perfect diffuser (absolute), or to the printer's own white (relative)",
                {.choices = {"absolute", "relative"}});
    command.add("--chart", a.job.chart, "chart to write: the mixtures that were fitted and their colours",
                {.unit = "FILE.csv"});
}

}  // namespace

Verb calibrate_icc_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateIccArguments>();
    CalibrateIccArguments& a = *arguments;
    Verb command(
        "icc", "Resins from a printer's ICC profile: its channels are taken as shares of the volume, the rest as white",
        "printer.icc --channels-are C,M,Y,K -o my-resins.json --chart chart.csv");
    command.add("profile", a.job.profile, "output profile of the printer (.icc, .icm)",
                {.unit = "FILE", .required = true});
    add_out_option(command, a.job.fit.out, "FILE",
                   "resin set to write; errors and doubts go beside it, as NAME.fit.json");
    add_overwrite_option(command, a.job.fit.overwrite);
    add_profile_options(command, a);
    command.add("--report", a.job.fit.report, "page to look at: colours of the profile and of the set",
                {.unit = "FILE.html"});
    command.add("--name", a.job.fit.name, "name of the set; empty: that of the file");
    command.add("--check", a.job.fit.check, "measured patches to predict with the result", {.unit = "FILE"});
    add_chart_options(command, a.chart, a.job.fit);
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
