// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a finished job says of itself: figures, pictures of the target and of what is expected, layers to look through.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "slicer/layers/layer_counts.h"
#include "slicer/part/job_body.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/print.h"

namespace voxtone::slicer {

/// What was measured while the job ran.
struct JobMeasurements {
    double read_s = 0, repair_s = 0, layers_s = 0, finish_s = 0;
    double encode_s = 0;  ///< summed over threads, like those of `counts`
    LayerCounts counts;
    std::uint64_t layer_bytes = 0;
};

/// Without support, which goes by the body.
[[nodiscard]] io::ReportPrinting printing_of(const PrinterProfile& printer, const Eigen::Vector3d& extent_mm,
                                             std::uint64_t layers);

/// Figures, warnings and sections; no pictures, and without the total time, which is not over.
[[nodiscard]] io::Report make_report(const OpenedJob& job, const JobBody& body, const io::StackDescription& stack,
                                     const Print& print, const JobMeasurements& figures);

/// The report's page, and the first pictures of its first view as files, for who shows many prints. Throws FileError.
void write_page(const std::filesystem::path& folder, const io::Report& report);

/// A few lines for a person. `total_s`: of the whole job; `has_report`: the page was written too.
[[nodiscard]] std::string summary_text(const Print& print, const io::Report& report, double total_s, bool has_report,
                                       const std::filesystem::path& folder);

}  // namespace voxtone::slicer
