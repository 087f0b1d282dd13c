// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/refit_job.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/warning.h"
#include "calibration/compare/refit.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {

namespace {

namespace fs = std::filesystem;

constexpr double least_told = 2;    // standard errors
constexpr double most_moved = 0.4;  // ln: three standard deviations of what is known (refit.cpp)

std::string json_of(const RefitJob& job, const Refit& refit, const optics::ResinSet& known) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-refit").add("version", 1).add("set", job.out).add("prior", known.name);
    json.add("prints", job.sheets).key("mean_ciede2000").begin_object();
    json.add("before", refit.before).add("after", refit.after);
    if (refit.left_out) json.add("left_out", *refit.left_out);
    json.end_object().key("resins").begin_list();
    for (std::size_t r = 0; r < refit.resins.size(); ++r) {
        const ResinChange& change = refit.resins[r];
        json.begin_object().add("role", known.resins[r].role);
        json.add("extinction_change", std::expm1(change.extinction)).add("extinction_error", change.extinction_error);
        json.add("absorption_change", std::expm1(change.absorption)).add("absorption_error", change.absorption_error);
        json.end_object();
    }
    json.end_list().end_object();
    return json.text();
}

std::string text_of(const RefitJob& job, const Refit& refit, const optics::ResinSet& known) {
    std::string text = fmt::format("{} of {} photographed print{}\n", known.name, job.sheets.size(),
                                   job.sheets.size() == 1 ? "" : "s");
    const auto told = [](double change, double error) {
        return fmt::format("{:+.0f} +- {:.0f} %", 100 * std::expm1(change), 100 * error);
    };
    for (std::size_t r = 0; r < refit.resins.size(); ++r) {
        const ResinChange& c = refit.resins[r];
        text += fmt::format("  {} ({}): extinction {}, absorption over scattering {}{}\n", known.resins[r].name,
                            known.resins[r].role, told(c.extinction, c.extinction_error),
                            told(c.absorption, c.absorption_error),
                            std::abs(c.extinction) < least_told * c.extinction_error &&
                                    std::abs(c.absorption) < least_told * c.absorption_error
                                ? ": as it was"
                                : "");
    }
    text += fmt::format("regions differ from the prediction by {:.2f} CIEDE2000 on average, with the new set {:.2f}",
                        refit.before, refit.after);
    if (refit.left_out) text += fmt::format("; a print that took no part by {:.2f}", *refit.left_out);
    return text +
           fmt::format("\nWrote {} and {}\n", job.out, fs::path(job.out).replace_extension(".fit.json").string());
}

}  // namespace

JobResult run_refit_job(const RefitJob& job, Progress& progress) {
    if (job.out.empty()) throw UsageError("--out is missing: the resin set to write");
    const fs::path side = fs::path(job.out).replace_extension(".fit.json");
    io::expect_outputs(std::vector<fs::path>{job.out, side}, job.overwrite);
    std::vector<RegionSheet> sheets;
    for (const std::string& file : job.sheets) {
        if (!is_region_sheet(file))
            throw InputError(fmt::format(
                "{}: holds no regions of a photographed print, as the others do; prints and patches are fitted apart",
                file));
        sheets.push_back(read_region_sheet(file));
    }
    const optics::ResinSet known = job.prior.empty() ? sheets.front().set : io::find_resin_set(job.prior);
    Refit refit = refit_resins(sheets, known);
    refit.set.name = job.name.empty() ? fs::path(job.out).stem().string() : job.name;
    refit.set.source = fmt::format("{}; moved by {} photographed prints (voxtone calibrate fit --prior {})",
                                   known.source, sheets.size(), known.name);
    refit.set = io::rounded_set(std::move(refit.set));
    if (refit.left_out && *refit.left_out > refit.before)
        progress.warn(named_warning(
            "refit-doubt",
            fmt::format("prints that took no part differ from the new set's prediction by {:.2f} CIEDE2000, from the "
                        "old one's by {:.2f}: these prints do not tell their resins; photograph them with a colour "
                        "checker, or print more colours.",
                        *refit.left_out, refit.before)));
    for (std::size_t r = 0; r < refit.resins.size(); ++r)
        if (std::abs(refit.resins[r].extinction) > most_moved)
            progress.warn(named_warning(
                "refit-doubt",
                fmt::format("{} would have to be {:.1f} times as strong as {} says, which no cartridge is: are the "
                            "photographs linear (--coding), and of these prints?",
                            known.resins[r].name, std::exp(refit.resins[r].extinction), known.name)));
    const std::string json = json_of(job, refit, known);
    io::write_whole_file(side, json + "\n");
    io::write_whole_file(job.out, io::resin_set_text(refit.set));
    return {json, text_of(job, refit, known)};
}

}  // namespace voxtone::calibration
