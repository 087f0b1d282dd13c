// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/chart_options.h"
#include "cli/calibrate/patch_options.h"

namespace voxtone::cli {

namespace {

struct CalibrateFitArguments {
    calibration::FitJob job;
    std::vector<std::string> files;
    PatchOptions patches;
    ChartOptions chart;
    std::optional<double> dot_spread;
    RunOptions run;
};

JobResult refit(const CalibrateFitArguments& a, const CalibrateJobs& jobs, Progress& progress) {
    return jobs.refit(
        {.sheets = a.files, .prior = a.job.prior, .name = a.job.name, .out = a.job.out, .overwrite = a.job.overwrite},
        progress);
}

int run(CalibrateFitArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        if (jobs.is_regions(a.files.front())) return refit(a, jobs, progress);
        if (a.files.size() > 1)
            throw UsageError(
                fmt::format("{}: patches are fitted one file at a time; several files are those of "
                            "photographed prints (regions.json of `compare --refit`)",
                            a.files[1]));
        a.job.patches = a.files.front();
        set_patch_model(a.patches, a.job.fit.model, a.job.measured);
        set_chart_fit(a.chart, a.job.chart);
        calibration::FitOptions& fit = a.job.fit;
        fit.fit_dot_spread = !a.dot_spread;
        if (!a.dot_spread) return jobs.fit(a.job, progress);
        if (fit.model.ideal_mixtures())
            throw UsageError("--dot-spread is of a printer's voxels; name it (--printer or --pitch)");
        fit.model.dot_spread = *a.dot_spread;
        return jobs.fit(a.job, progress);
    });
}

void add_fit_options(Verb& command, CalibrateFitArguments& a) {
    calibration::FitOptions& fit = a.job.fit;
    command.add("--resins", fit.expected,
                "resins that must be among the patches, and columns of these names: C,M,Y,K,W",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--noise", fit.noise, "standard error of a reflectance, where the table gives none");
    command.add("--g", fit.model.g, "mean cosine of the scattering angle; patches cannot tell it",
                {.not_with = "--prior", .group = "Model"});
    command.add("--eta", fit.model.eta, "refractive index; patches cannot tell it",
                {.not_with = "--prior", .group = "Model"});
    command.add("--dot-spread", a.dot_spread,
                "of --printer's voxels in a target's mixtures: 0 sharp, 1 run together to an ideal mixture; empty: "
                "what patches tell, else 0; a chart tells its own",
                {.range = {0.0, 1.0}, .group = "Model"});
}

}  // namespace

Verb calibrate_fit_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateFitArguments>();
    CalibrateFitArguments& a = *arguments;
    Verb command("fit", "Albedo and extinction of every resin, with their errors, from measured patches",
                 "patches.csv --resins C,M,Y,K,W -o my-resins.json --report my-resins.html");
    command.add(
        "patches", a.files,
        "a target, CSV: top,backing,thickness_mm,R,G,B or wavelengths in nm, 45/0 reflectance of a perfect "
        "diffuser "
        "is 1; or a chart of mixtures, CSV with a column of shares for each resin and L,a,b, X,Y,Z or wavelengths, "
        "CGATS text or CxF3; or regions.json of photographed prints (`compare --refit`), several of them",
        {.unit = "FILE...", .required = true, .count = {1, 1000}});
    add_out_option(command, a.job.out, "FILE", "resin set to write; errors and doubts go beside it, as NAME.fit.json");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--report", a.job.report, "page to look at: patches measured and predicted, curves, errors",
                {.unit = "FILE.html"});
    add_patch_map_options(command, a.job.map);
    command.add("--name", a.job.name, "name of the set; empty: that of the file");
    add_fit_options(command, a);
    add_patch_options(command, a.patches, a.job.measured);
    command.add("--prior", a.job.prior,
                "what edge profiles say of the same resins: the NAME.edge.json of `calibrate edge fit`, whose g and "
                "eta hold; values and their errors count beside the patches. Of photographed prints: the set that they "
                "make better; empty: by which they were predicted",
                {.unit = "FILE|SET"});
    command.add("--check", a.job.check, "other patches to predict with the result", {.unit = "FILE"});
    command.add("--g-sweep", a.job.g_sweep,
                "also fit for g from -0.9 to 0.9 and print how well each explains the patches (of --check, if given)");
    add_chart_options(command, a.chart, a.job);
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
