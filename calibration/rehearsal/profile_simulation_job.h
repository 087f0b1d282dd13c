// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate simulate-profile`: the photographs that `calibrate profile` measures, of a slab of a known resin
// (profile_simulation.h), as files, with the truth beside them.
#pragma once

#include <cstdint>
#include <string>

#include "base/job_result.h"
#include "calibration/rehearsal/profile_simulation.h"

namespace voxtone::calibration {

struct ProfileSimulationJob {
    SpotCamera camera;               ///< its seed is that of the paths too
    std::string resins;              ///< set or file, RGB
    std::string role;                ///< of the slab's resin
    double thickness_mm = 0;         ///< of the slab, above 0
    std::uint32_t paths = 1u << 18;  ///< per channel
    std::string out;                 ///< folder for reflection-NN.exr, reflection-dark-NN.exr, ... and truth.json
    bool overwrite = false;          ///< files that are there are replaced

    /// Throws UsageError or InputError that names the option and the rule it breaks.
    void validate() const;
};

/// Throws Error (with its exit code). The same files for any number of threads.
[[nodiscard]] JobResult run_profile_simulation(const ProfileSimulationJob& job, Progress& progress);

}  // namespace voxtone::calibration
