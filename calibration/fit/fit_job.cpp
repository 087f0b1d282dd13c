// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/fit_job.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "calibration/chart/chart_order.h"
#include "calibration/chart/chart_text.h"
#include "calibration/fit/channel_fit.h"
#include "calibration/fit/chart_page.h"
#include "calibration/fit/ended_fit.h"
#include "calibration/fit/fit_report.h"
#include "calibration/fit/fit_text.h"
#include "calibration/fit/spread_fit.h"
#include "calibration/target/target_file.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

/// OUT.fit.json beside OUT.json.
fs::path side_file(const fs::path& out) { return fs::path(out).replace_extension(".fit.json"); }

FitOptions options_of(const FitJob& job) {
    FitOptions options = job.fit;
    options.name = job.name.empty() ? fs::path(job.out).stem().string() : job.name;
    return options;
}

/// Roles that the user names, and those that the sets have that a fit is given.
MeasuredPatchOptions measured_options(const FitJob& job, const FitOptions& fit) {
    MeasuredPatchOptions measured = job.measured;
    measured.reading.resins = fit.expected;
    for (const optics::Resin& resin : io::find_resin_set(job.lengths_from).resins)
        measured.reading.known.push_back(resin.role);
    for (const ResinPrior::Resin& resin : fit.prior.resins) measured.reading.known.push_back(resin.role);
    return measured;
}

void expect_chart_options(const FitJob& job) {
    const auto refuse = [&](bool given, std::string_view option, std::string_view why) {
        if (given) throw UsageError(fmt::format("{} with {}, a chart: {}. Leave it out.", option, job.patches, why));
    };
    refuse(job.g_sweep, "--g-sweep", "its colours look the same with any g");
    refuse(!job.map.target.empty(), "--target", "its patches lie on no target");
}

void expect_laminate_options(const FitJob& job) {
    for (const auto& [option, value] : {std::pair{"--prior", job.prior}, std::pair{"--squares", job.squares}})
        if (!value.empty())
            throw UsageError(fmt::format("{} with {}, laminates, which tell lengths themselves. Leave it out.", option,
                                         job.patches));
}

/// All that a fit leaves, when nothing can fail any more but the disk; the set last.
void write_fit(const FitJob& job, const optics::ResinSet& set, const std::string& json, const std::string& page) {
    if (!job.report.empty()) io::write_whole_file(job.report, page);
    io::write_whole_file(side_file(job.out), json + "\n");
    io::write_whole_file(job.out, io::resin_set_text(set));
}

/// Where the target is known its squares have ends.
EndedFit fit_squares(const FitJob& job, const PatchTable& table, const FitOptions& options, Progress& progress) {
    const std::optional<Target> target =
        job.map.target.empty() ? std::nullopt : std::optional(read_target(job.map.target));
    const bool has_ends = target && target->surfaces.empty();  // hardly any light goes sideways on what is opaque
    if (has_ends) return fit_ended_squares(table, *target, options, &progress);
    if (!target && clear_is_told(table, "T"))
        progress.warn(named_warning("assumed",
                                    "squares of clear resin (T) are taken as without end, as wide plates in wide light "
                                    "are; give --target where they are a target's, whose walls are white"));
    EndedFit endless;
    endless.fit = fit_resins(table, options, &progress);
    endless.table = table;
    return endless;
}

/// How far resin runs, by checkers of resins that squares have told.
std::optional<SpreadFit> spread_of(const FitJob& job, PatchTable checkers, const ResinFit& fit,
                                   const FitOptions& options, Progress& progress) {
    if (checkers.patches.empty()) return std::nullopt;
    if (!job.map.target.empty())
        take_ends_off_checkers(checkers, read_target(job.map.target), fit.set, options.model.under == UnderBase::air);
    return fit_spread(checkers, fit.set, options.noise, fit.covariance, 0, &progress);
}

}  // namespace

void FitJob::validate() const {
    if (patches.empty()) throw UsageError("calibrate fit: no file of measured patches");
    if (out.empty()) throw UsageError("--out is missing: the resin set to write");
    if (!prior.empty() && g_sweep)
        throw UsageError(
            "--g-sweep with --prior: what the edges say holds at their own g alone. Leave one of them out.");
    map.validate_of_squares(report);
    calibration::validate(options_of(*this));
}

std::vector<fs::path> FitJob::outputs() const {
    std::vector<fs::path> files{out, side_file(out)};
    if (!report.empty()) files.emplace_back(report);
    return files;
}

FitOptions fit_options(const FitJob& job) {
    FitOptions options = options_of(job);
    if (job.prior.empty()) return options;
    options.prior = read_resin_prior(job.prior);
    options.model.g = options.prior.g, options.model.eta = options.prior.eta;
    return options;
}

JobResult run_chart_fit(const FitJob& job, const FitOptions& fit, const PatchTable& table, Progress& progress) {
    expect_chart_options(job);
    if (table.is_of_laminates()) expect_laminate_options(job);
    ChartFitOptions options = job.chart;
    options.name = fit.name;
    options.g = fit.model.g, options.eta = fit.model.eta, options.pitch_mm = fit.model.pitch_mm;
    options.expected = fit.expected;
    options.edges = fit.prior;
    options.lengths_from = io::find_resin_set(job.lengths_from);
    const MeasuredPatchOptions measured = measured_options(job, fit);
    if (!job.squares.empty()) options.squares = read_measured_patches(job.squares, measured, fit.model, progress);
    const PatchTable others =
        job.check.empty() ? PatchTable{} : read_measured_patches(job.check, measured, fit.model, progress);
    expect_order(table, options);
    ChartFit found = fit_chart(table, options, &progress);
    found.set = io::rounded_set(std::move(found.set));
    for (const std::string& warning : found.warnings) progress.warn(warning);
    std::string text = chart_fit_text(found);
    const PatchTable& shown = job.check.empty() ? table : others;
    const PatchCheck check = check_resins(found.set, shown, fit.model);
    if (!job.check.empty()) text += fmt::format("\n{}\n{}", job.check, check_text(check, others));
    const std::string page =
        job.report.empty() ? std::string() : chart_fit_html(found, shown, check, chart_of_patches(shown));
    write_fit(job, found.set, chart_fit_json(found), page);
    text += fmt::format("\nWrote {} and {}\n", job.out, side_file(job.out).string());
    return {chart_fit_json(found), text};
}

JobResult run_fit_job(const FitJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs(job.outputs(), job.overwrite);
    const FitOptions options = fit_options(job);
    const MeasuredPatchOptions measured = measured_options(job, options);
    PatchTable checkers;
    const PatchTable read = read_measured_patches(job.patches, measured, options.model, progress, &checkers);
    if (read.is_chart) {
        job.map.validate(job.report);
        return run_chart_fit(job, options, read, progress);
    }
    if (!job.squares.empty())
        throw UsageError(
            fmt::format("--squares with {}, which is a target of squares itself. Leave it out.", job.patches));
    const PatchMap map = job.report.empty() ? PatchMap{} : read_patch_map(read, job.map, progress);
    const bool checked = !job.check.empty();
    const PatchTable others =
        checked ? read_measured_patches(job.check, measured, options.model, progress) : PatchTable{};
    EndedFit ended = fit_squares(job, read, options, progress);
    const PatchTable& table = ended.table;
    ResinFit& fit = ended.fit;
    FitExtras extras;
    extras.spread = spread_of(job, std::move(checkers), fit, options, progress);
    if (extras.spread && extras.spread->is_told())
        fit.set.dot_spread = fit.dot_spread_error = 0;  // the same, seen twice
    fit.set = io::rounded_set(std::move(fit.set));
    for (const std::string& warning : fit.warnings) progress.warn(warning);
    extras.ends = ended.most;
    std::string text = fit_text(fit, table) + ends_sentence(ended) + spread_sentence(extras.spread);
    if (checked) {
        extras.check = check_resins(fit.set, others, options.model);
        extras.checked = &others;
        text += fmt::format("\n{}\n{}", job.check, check_text(*extras.check, others));
    }
    if (job.g_sweep) {
        FitOptions swept = options;
        swept.model.dot_spread = fit.set.dot_spread, swept.fit_dot_spread = false;
        extras.sweep = sweep_g(table, extras.checked, swept, progress);
        text += sweep_text(extras.sweep);
    }
    const std::string page = job.report.empty() ? std::string() : fit_report_html(fit, table, options, map);
    write_fit(job, fit.set, fit_json(fit, table, {.spread = extras.spread}), page);
    text += fmt::format("\nWrote {} and {}\n", job.out, side_file(job.out).string());
    return {fit_json(fit, table, extras), text};
}

}  // namespace voxtone::calibration
