// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate simulate`: the photograph that a target would give if printed with known resins
// (photo_simulation.h), as a file; of a chart also the table that a spectrophotometer would give: L, a, b of thick
// patches as the set is measured (optics/layered/flat_colour.h), with noise of its own in each.
#pragma once

#include <functional>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/rehearsal/photo_simulation.h"

namespace voxtone::calibration {

struct PhotoSimulationJob {
    PhotoOptions photo;
    std::string target;                              ///< its description (calibration/target/target_file.h), or a print
    std::function<FlatThing(Progress&)> print = {};  ///< what `target` looks like where it is a print
    std::string resins = "vero-opaque";              ///< set or file; empty: of a print that of its job
    std::string checker = "colorchecker24";          ///< chart, or its file
    MixtureKind mixtures = MixtureKind::dithered;
    bool eight_bits = false;  ///< of sRGB codes instead of 16 linear ones
    std::string out;          ///< .png, .tif or .exr; .csv: the table of a chart
    double lab_noise = 0.3;   ///< of the table's L, a, b, standard deviation, [0, 10]
    std::string truth;        ///< table of what the squares truly reflect; empty: none
    bool overwrite = false;   ///< files that are there are replaced

    /// Throws InputError that names the option and the rule it breaks.
    void validate() const;
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_photo_simulation(const PhotoSimulationJob& job, Progress& progress);

}  // namespace voxtone::calibration
