// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate targets`: wanted profiles of one albedo and rising width between two laminates
// (scattering/design/widening_targets.h), as files that `laminate search` takes. Laminates of resins are computed in
// all directions, others by layer profiles.
#pragma once

#include <cstdint>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "scattering/jobs/named_laminate.h"

namespace voxtone::scattering {

struct LaminateTargetsJob {
    std::string narrow, wide;  ///< laminates, as in named_laminate.h
    NamedLaminateOptions setting{.coefficients = 128};
    std::uint32_t count = 5;         ///< [1, 1000]
    std::uint32_t paths = 1u << 18;  ///< per laminate and channel, >= 2
    std::uint64_t seed = 1;
    std::string out;  ///< folder for target-1.json (narrowest) ... and targets.svg
    bool overwrite = false;
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_laminate_targets(const LaminateTargetsJob& job, Progress& progress);

}  // namespace voxtone::scattering
