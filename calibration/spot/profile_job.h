// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate profile`: from photographs of a lit point on one or both sides of a slab to a file of its
// scattering profile (profile_measurement.h). Both sides: a layer, of known thickness. Reflection alone: what is wanted
// of a surface, a target for stacks to reach.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "calibration/spot/albedo_photographs.h"
#include "calibration/spot/exposure_series.h"
#include "calibration/spot/profile_measurement.h"

namespace voxtone::calibration {

/// Photographs of one side, from short to long, each with a dark frame of the same time.
struct ProfileSide {
    std::vector<ExposureFile> lit, dark;
    std::optional<Eigen::Vector3d> total;  ///< measured albedo of each channel, in (0, 1]
    double mm_per_px = 0;                  ///< width of a pixel on the slab
    [[nodiscard]] bool given() const { return !lit.empty() || !dark.empty() || total; }
};

struct ProfileJob {
    ProfileSide reflection, transmission;  ///< transmission: none for a target
    std::optional<CardPhotograph> card;    ///< for the reflection's total
    std::optional<ScreenPhotographs> lcd;  ///< for the transmission's
    std::optional<double> thickness_mm;    ///< of the slab; none for a target
    ProfileMeasureOptions measure;         ///< its mm_per_px does not count: the sides have their own
    std::optional<double> spot_mm;         ///< radius of what was lit: says which waves it blurs
    std::string name;                      ///< of the material; empty: that of the file `out`
    std::string out;                       ///< profile (io/profiles/profile_file.h)
    std::string plot;                      ///< its picture (profile_plot.h); empty: beside it, as NAME.svg
    bool overwrite = false;                ///< files that are there are replaced

    /// Throws UsageError or InputError that names the option and the rule it breaks.
    void validate() const;
};

/// Throws Error (with its exit code). Warns of what is doubtful.
[[nodiscard]] JobResult run_profile_job(const ProfileJob& job, Progress& progress);

}  // namespace voxtone::calibration
