// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_fit_job.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/edge/dictionary_file.h"
#include "calibration/edge/edge_chart.h"
#include "calibration/edge/edge_fit_text.h"
#include "calibration/edge/edge_report.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

constexpr double own_least_sigma = 0.5, own_most_sigma = 40, own_ratio = 1.22, own_same_thickness = 0.15;

fs::path values_file(const fs::path& out) { return fs::path(out).replace_extension(".edge.json"); }

// A grid for these slabs: extinctions in even steps, g only where it is wanted.
EdgeGrid own_grid(const std::vector<EdgeProfile>& profiles, const EdgeFitJob& job) {
    EdgeGrid grid;
    grid.thickness_mm.clear();
    std::vector<double> slabs;
    for (const EdgeProfile& profile : profiles) slabs.push_back(profile.thickness_mm);
    std::ranges::sort(slabs);
    for (const double t : slabs)
        if (grid.thickness_mm.empty() || t > grid.thickness_mm.back() * (1 + own_same_thickness / 2))
            grid.thickness_mm.push_back(t);
    grid.g.assign(1, job.fit.g);
    if (job.fit.anisotropy != EdgeAnisotropy::given) grid.g = {0, 0.2, 0.35, 0.5, 0.65, 0.8};
    for (double s = own_least_sigma; s < own_most_sigma * own_ratio; s *= own_ratio) grid.sigma_t.push_back(s);
    grid.paths = job.paths;
    grid.seed = job.seed;
    validate(grid);
    return grid;
}

std::shared_ptr<const EdgeDictionary> own_dictionary(const std::vector<EdgeProfile>& profiles, const EdgeFitJob& job,
                                                     const EdgeSetup& setup, Progress& progress) {
    EdgeDictionary dictionary{setup, own_grid(profiles, job), {}};
    dictionary.records.resize(dictionary.grid.runs());
    progress.begin_stage("paths", dictionary.grid.runs(), "runs");
    for (std::size_t run = 0; run < dictionary.grid.runs(); ++run) {
        dictionary.records[run] = edge_record(setup, dictionary.grid, run, &progress);
        progress.advance();
    }
    progress.end_stage();
    return std::make_shared<const EdgeDictionary>(std::move(dictionary));
}

}  // namespace

void EdgeFitJob::validate() const {
    if (profiles.empty()) throw UsageError("calibrate edge fit: no file of profiles");
    if (out.empty()) throw UsageError("--out is missing: the resin set to write");
    if (!(fit.metric.lambda >= 0 && fit.metric.lambda <= 1e6))
        throw InputError(fmt::format("--lambda: {}; expected 0 to 1e6", fit.metric.lambda));
    if (fit.metric.wavelet_level < 1 || fit.metric.wavelet_level > 6)
        throw InputError(fmt::format("--wavelet-level: {}; expected 1 to 6", fit.metric.wavelet_level));
    if (!(fit.g > -0.95 && fit.g < 0.95)) throw InputError(fmt::format("--g: {}; expected -0.95 to 0.95", fit.g));
    if (!(fit.mu_from > 0.2 && fit.mu_to < 5 && fit.mu_from <= fit.mu_to))
        throw InputError(
            fmt::format("--mu: {},{}; expected a range that rises, within 0.2 and 5", fit.mu_from, fit.mu_to));
}

JobResult run_edge_fit_job(const EdgeFitJob& job, Progress& progress) {
    job.validate();
    std::vector<fs::path> files{job.out, values_file(job.out)};
    if (!job.report.empty()) files.emplace_back(job.report);
    io::expect_outputs(files, job.overwrite);
    const EdgeSetup setup = read_edge_setup(job.setup);
    const std::vector<EdgeProfile> profiles = read_edge_profiles(job.profiles);
    check_edge_profiles(profiles, job.profiles);
    std::optional<PatchTable> chart;
    if (!job.chart.empty()) {
        MeasuredPatchOptions measured = job.chart_measured;
        for (const EdgeProfile& profile : profiles) measured.reading.known.push_back(profile.resin);
        chart = read_measured_patches(job.chart, measured, job.chart_model, progress);
    }
    EdgeProfileTable table(job.dictionary.empty()
                               ? own_dictionary(profiles, job, setup, progress)
                               : std::make_shared<const EdgeDictionary>(read_dictionary(job.dictionary)),
                           setup);
    EdgeFitOptions options = job.fit;
    options.eta = setup.assembly.slab_index;
    options.name = job.name.empty() ? fs::path(job.out).stem().string() : job.name;
    EdgeFit fit = fit_edges(profiles, table, options, &progress);
    if (chart) complete_by_chart(fit, *chart, job.chart_model);
    fit.set = io::rounded_set(std::move(fit.set));
    EdgeSimilarity similarity;
    if (!job.report.empty()) similarity = edge_similarity(fit, profiles, table, options, &progress);
    for (const std::string& warning : fit.warnings) progress.warn(warning);
    io::write_whole_file(job.out, io::resin_set_text(fit.set));
    io::write_whole_file(values_file(job.out), edge_fit_json(fit, options) + "\n");
    if (!job.report.empty())
        io::write_whole_file(job.report, edge_report_html(fit, profiles, table, options, similarity));
    return {edge_fit_json(fit, options),
            edge_fit_text(fit) + fmt::format("\nWrote {} and {}\n", job.out, values_file(job.out).string())};
}

}  // namespace voxtone::calibration
