// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate predict`: what a laminate reflects and transmits, by layer profiles and, if asked for, by Monte
// Carlo.
//
// Resins: every layer's profile is made at its own thickness, the first together with the surface
// (optics/profiles/resin_laminate.h). Measured profiles: other thicknesses by Kubelka and Munk's law, a surface as a
// layer of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "scattering/jobs/named_laminate.h"

namespace voxtone::scattering {

struct LaminatePredictJob {
    std::string laminate;  ///< a laminate file (.json), or layers as "W 0.3, K 0.1", top first
    NamedLaminateOptions setting;
    bool check = false;              ///< Monte Carlo beside it
    std::uint32_t paths = 1u << 18;  ///< per layer and channel, >= 2
    std::uint64_t seed = 1;
    std::vector<std::string> files;  ///< to write: .json (voxtone-profile), .svg
    bool overwrite = false;          ///< files that are there are replaced
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_laminate_predict(const LaminatePredictJob& job, Progress& progress);

}  // namespace voxtone::scattering
