// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/chart_options.h"
#include "cli/program/help.h"

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

void add_profile_options(CLI::App& command, CalibrateIccArguments& a) {
    calibration::IccChartOptions& options = a.job.options;
    command
        .add_option("--channels-are", options.channels_are,
                    "resin of each channel, in order: C,M,Y,K; empty: those of CMYK or CMY")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_value(command, "--rest", options.rest, "resin of what the channels leave")->type_name("ROLE");
    add_count(command, "--patches", options.patches,
              "mixtures to take from the profile's table; its measurements, where it carries them, go before");
    add_value(command, "--intent", a.intent,
              "colours relative to a perfect diffuser (absolute), or to the printer's own white (relative)")
        ->check(CLI::IsMember({"absolute", "relative"}));
    command.add_option("--chart", a.job.chart, "chart to write: the mixtures that were fitted and their colours")
        ->type_name("FILE.csv");
}

}  // namespace

Command add_calibrate_icc_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateIccArguments>();
    CalibrateIccArguments& a = *arguments;
    CLI::App* command = calibrate.add_subcommand(
        "icc",
        "Resins from a printer's ICC profile: its channels are taken as shares of the volume, the rest as white");
    command->add_option("profile", a.job.profile, "output profile of the printer (.icc, .icm)")
        ->required()
        ->type_name("FILE");
    add_out_option(*command, a.job.fit.out, "FILE",
                   "resin set to write; errors and doubts go beside it, as NAME.fit.json");
    add_overwrite_option(*command, a.job.fit.overwrite);
    add_profile_options(*command, a);
    command->add_option("--report", a.job.fit.report, "page to look at: colours of the profile and of the set")
        ->type_name("FILE.html");
    command->add_option("--name", a.job.fit.name, "name of the set; empty: that of the file");
    command->add_option("--check", a.job.fit.check, "measured patches to predict with the result")->type_name("FILE");
    add_chart_options(*command, a.chart, a.job.fit);
    add_run_options(*command, a.run);
    add_example(*command, "printer.icc --channels-are C,M,Y,K -o my-resins.json --chart chart.csv");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

}  // namespace voxtone::cli
