// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate photo`: from photographs of one target to its table of patches (photo_measurement.h), with a
// picture of what was sampled beside each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/photo/photo_measurement.h"

namespace voxtone::calibration {

struct PhotoJob {
    std::vector<std::string> photos;         ///< one or more; several are averaged
    std::string target;                      ///< its description (calibration/target/target_file.h)
    std::string checker = "colorchecker24";  ///< chart beside the target, or its file
    PhotoMeasureOptions measure;             ///< corners by hand are those of one photograph
    PhotoChannels channels = PhotoChannels::rgb;
    std::optional<double> top_mm;  ///< thickness of the squares as they are, in (0, 10]; none: as they were printed
    std::string out;               ///< table of patches (calibration/patches/patch_file.h)
    std::string overlay;     ///< picture of what was sampled, the next ones as NAME-2.png, ...; empty: beside the table
    std::string picture;     ///< the target as it was measured, straightened (target_picture.h); empty: none
    bool overwrite = false;  ///< files that are there are replaced

    /// Throws UsageError that names the option and the rule it breaks.
    void validate() const;
};

/// Throws Error (with its exit code). Warns of what is doubtful.
[[nodiscard]] JobResult run_photo_job(const PhotoJob& job, Progress& progress);

}  // namespace voxtone::calibration
