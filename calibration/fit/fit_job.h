// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate fit`: from a file of patches to a file of resins, with what is known of their errors beside it.
// Thin squares of a target: calibration/fit/resin_fit.h, with a page to look at, a check with other patches and a sweep
// over g. A chart of mixtures, or of laminates: calibration/chart/chart_fit.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "calibration/chart/chart_fit.h"
#include "calibration/fit/patch_map.h"
#include "calibration/fit/resin_fit.h"
#include "calibration/patches/measured_patches.h"

namespace voxtone::calibration {

struct FitJob {
    std::string patches;  ///< file (calibration/patches/patch_file.h)
    MeasuredPatchOptions measured;
    FitOptions fit;                            ///< of a target; its name does not count:
    ChartFitOptions chart;                     ///< of a chart of mixtures; its name, g, eta and lengths neither
    std::string lengths_from = "vero-opaque";  ///< set or file whose white gives a chart's lengths
    std::string squares;                       ///< file of thin squares that tell a chart's lengths; empty: none
    std::string prior;       ///< NAME.edge.json of edge profiles (resin_prior.h), whose g and eta hold; empty: none
    std::string name;        ///< of the set; empty: that of the file `out`
    std::string check;       ///< file of other patches to predict with the result; empty: none
    bool g_sweep = false;    ///< also fit for other g (g_sweep.h)
    std::string out;         ///< resin set; errors and doubts go beside it, as NAME.fit.json
    std::string report;      ///< page (fit_report.h); empty: none
    PatchMapFiles map;       ///< of the page
    bool overwrite = false;  ///< files that are there are replaced

    /// Throws UsageError or InputError that names the option, its value and the rule.
    void validate() const;
    /// Files that are written.
    [[nodiscard]] std::vector<std::filesystem::path> outputs() const;
};

/// Throws Error (with its exit code); nothing is written then, unless it is the disk that fails.
[[nodiscard]] JobResult run_fit_job(const FitJob& job, Progress& progress);

/// The options of a job: its name, and what its edges know. Throws FileError, InputError.
[[nodiscard]] FitOptions fit_options(const FitJob& job);

/// The same of a chart that was read already, once its outputs were asked for; `job.patches` names it in messages.
[[nodiscard]] JobResult run_chart_fit(const FitJob& job, const FitOptions& fit, const PatchTable& table,
                                      Progress& progress);

}  // namespace voxtone::calibration
