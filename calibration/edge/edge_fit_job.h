// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate edge fit`: from profiles (edge_profiles.h) to a set of resins, with what is known of its errors
// beside it and a page to look at.
//
// Without a dictionary one is traced for the setup, of the slabs' thicknesses, coarser than the paper's: enough for the
// fit's own interpolation (profile_table.h), and two core minutes of work.
#pragma once

#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/edge/edge_fit.h"
#include "calibration/patches/measured_patches.h"

namespace voxtone::calibration {

struct EdgeFitJob {
    std::string profiles, setup, dictionary;  ///< setup, dictionary: empty for the defaults, for one of its own
    EdgeFitOptions fit;                       ///< its name and eta do not count
    std::string name;                         ///< of the set; empty: that of the file `out`
    std::string chart;  ///< patches that complete what edges do not tell (edge_chart.h); empty: none
    MeasuredPatchOptions chart_measured;
    PatchModelOptions chart_model;   ///< its g and eta do not count
    std::uint32_t paths = 1u << 19;  ///< per run of its own dictionary
    std::uint64_t seed = 1;
    std::string out;     ///< resin set; errors and doubts beside it, as NAME.edge.json
    std::string report;  ///< page; empty: none
    bool overwrite = false;

    void validate() const;
};

[[nodiscard]] JobResult run_edge_fit_job(const EdgeFitJob& job, Progress& progress);

}  // namespace voxtone::calibration
