// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/icc_job.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "calibration/patches/patch_file.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {

namespace {

FitJob fit_of(const IccJob& job) {
    FitJob fit = job.fit;
    fit.patches = job.profile;
    return fit;
}

std::string icc_origin(const IccChart& chart) {
    return chart.measured.empty() ? fmt::format("sampled from the table of an ICC profile ({})", chart.colour_space)
                                  : fmt::format("measurements that an ICC profile carries ({})", chart.measured);
}

std::string icc_text(const IccJob& job, const IccChart& chart) {
    return fmt::format("{} ({}): {} mixtures, {}; white L {:.1f}, a {:.1f}, b {:.1f}\n", job.profile,
                       chart.description.empty() ? "without a description" : chart.description,
                       chart.table.patches.size(), icc_origin(chart), chart.white.x(), chart.white.y(),
                       chart.white.z());
}

}  // namespace

void IccJob::validate() const {
    if (profile.empty()) throw UsageError("calibrate icc: no ICC profile");
    options.validate();
    fit_of(*this).validate();
}

JobResult run_icc_job(const IccJob& job, Progress& progress) {
    job.validate();
    const FitJob fit = fit_of(job);
    std::vector<std::filesystem::path> files = fit.outputs();
    if (!job.chart.empty()) files.emplace_back(job.chart);
    io::expect_outputs(files, fit.overwrite);
    const IccChart chart = read_icc_chart(job.profile, job.options, &progress);
    for (const std::string& note : chart.table.notes) progress.warn(named_warning("assumed", note));
    JobResult result = run_chart_fit(fit, fit_options(fit), chart.table, progress);
    if (!job.chart.empty()) {
        io::write_whole_file(job.chart, patch_table_text(chart.table, icc_origin(chart)));
        result.text += fmt::format("Wrote {}\n", job.chart);
    }
    result.text = icc_text(job, chart) + "\n" + result.text;
    return result;
}

}  // namespace voxtone::calibration
