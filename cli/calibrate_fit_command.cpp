// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/calibration/fit/fit_report.h"
#include "voxtone/calibration/fit/fit_text.h"
#include "voxtone/calibration/fit/resin_fit.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/patch_options.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::cli {

namespace {

namespace fs = std::filesystem;

struct CalibrateFitArguments {
    std::string patches, out, report, check, name;
    PatchOptions measured;
    calibration::FitOptions fit;
    bool sweep = false;
    double white = 1;
    int threads = 0;
    ConsoleOptions console;
};

/// OUT.fit.json beside OUT.json.
fs::path side_file(const fs::path& out) { return fs::path(out).replace_extension(".fit.json"); }

std::vector<calibration::SweepLine> sweep(const calibration::PatchTable& table, const calibration::PatchTable* others,
                                          calibration::FitOptions options, Progress& progress) {
    std::vector<calibration::SweepLine> lines;
    for (int step = -9; step <= 9; ++step) {
        options.model.g = step / 10.0;
        const auto fit = calibration::fit_resins(table, options, &progress);
        const double freedom = static_cast<double>(fit.freedom) * static_cast<double>(fit.chi2.size());
        lines.push_back({options.model.g,
                         freedom > 0 ? std::accumulate(fit.chi2.begin(), fit.chi2.end(), 0.0) / freedom : 0,
                         others ? calibration::check_resins(fit.set, *others, options.model).differences
                                : fit.patches.differences});
    }
    return lines;
}

int run(const CalibrateFitArguments& arguments) {
    const ThreadLimit limit(static_cast<std::size_t>(arguments.threads));
    return run_on_console(arguments.console, [&](Progress& progress) {
        calibration::FitOptions options = arguments.fit;
        options.name = arguments.name.empty() ? fs::path(arguments.out).stem().string() : arguments.name;
        validate(options);
        const calibration::PatchTable table =
            read_patches(arguments.patches, arguments.measured, options.model, progress);
        calibration::PatchTable others;
        if (!arguments.check.empty())
            others = read_patches(arguments.check, arguments.measured, options.model, progress);
        const calibration::ResinFit fit = calibration::fit_resins(table, options, &progress);

        std::string text = calibration::fit_text(fit, table), json = calibration::fit_json(fit, table);
        io::write_whole_file(arguments.out, io::resin_set_text(fit.set));
        io::write_whole_file(side_file(arguments.out), json + "\n");
        json.pop_back();
        if (!arguments.check.empty()) {
            const auto check = calibration::check_resins(fit.set, others, options.model);
            text += fmt::format("\n{}\n{}", arguments.check, calibration::check_text(check, others));
            json += fmt::format(",\"check\":{}", calibration::check_json(check, others));
        }
        if (arguments.sweep) {
            const auto lines = sweep(table, arguments.check.empty() ? nullptr : &others, options, progress);
            text += calibration::sweep_text(lines);
            json += fmt::format(",\"g_sweep\":{}", calibration::sweep_json(lines));
        }
        if (!arguments.report.empty())
            io::write_whole_file(arguments.report, calibration::fit_report_html(fit, table, options));
        text += fmt::format("\nWrote {} and {}\n", arguments.out, side_file(arguments.out).string());
        return CommandResult{json + "}", text};
    });
}

}  // namespace

Command add_calibrate_fit_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibrateFitArguments>();
    CLI::App* command = calibrate.add_subcommand(
        "fit", "Albedo and extinction of every resin, with their errors, from measured patches");
    command
        ->add_option(
            "patches", arguments->patches,
            "CSV: top,backing,thickness_mm,R,G,B or wavelengths in nm; 45/0 reflectance of a perfect diffuser is 1")
        ->required()
        ->type_name("FILE");
    command
        ->add_option("-o,--out", arguments->out, "resin set to write; errors and doubts go beside it, as NAME.fit.json")
        ->required()
        ->type_name("FILE");
    command
        ->add_option("--report", arguments->report, "page to look at: patches measured and predicted, curves, errors")
        ->type_name("FILE.html");
    command->add_option("--name", arguments->name, "name of the set; empty: that of the file");
    command->add_option("--resins", arguments->fit.expected, "resins that must be among the patches: C,M,Y,K,W")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--noise", arguments->fit.noise, "standard error of a reflectance, where the table gives none")
        ->capture_default_str();
    command->add_option("--g", arguments->fit.model.g, "mean cosine of the scattering angle; patches cannot tell it")
        ->group("Model")
        ->capture_default_str();
    command->add_option("--eta", arguments->fit.model.eta, "refractive index; patches cannot tell it")
        ->group("Model")
        ->capture_default_str();
    add_patch_options(*command, arguments->measured);
    command->add_option("--check", arguments->check, "other patches to predict with the result")->type_name("FILE");
    command->add_flag(
        "--g-sweep", arguments->sweep,
        "also fit for g from -0.9 to 0.9 and print how well each explains the patches (of --check, if given)");
    add_threads_option(*command, arguments->threads);
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
