// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone stack targets`: wanted profiles of one albedo and rising width between two stacks
// (halftone/stacks/widening_targets.h), as files that `stack search` takes. Stacks of resins are traced by Monte Carlo,
// others by layer profiles.
#pragma once

#include <cstdint>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/stacks/named_stack.h"

namespace voxtone::slicer {

struct StackTargetsJob {
    std::string narrow, wide;  ///< stacks, as in named_stack.h
    NamedStackOptions setting{.coefficients = 128};
    std::uint32_t count = 5;         ///< [1, 1000]
    std::uint32_t paths = 1u << 18;  ///< per stack and channel, >= 2
    std::uint64_t seed = 1;
    std::string out;  ///< folder for target-1.json (narrowest) ... and targets.svg
    bool overwrite = false;
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_stack_targets(const StackTargetsJob& job, Progress& progress);

}  // namespace voxtone::slicer
