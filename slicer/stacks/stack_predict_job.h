// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone stack predict`: what a stack of layers reflects and transmits, by layer profiles and, if asked for, by Monte
// Carlo.
//
// Resins: every layer's profile is made at its own thickness, the first together with the surface
// (optics/profiles/resin_stack.h). Measured profiles: other thicknesses by Kubelka and Munk's law, a surface as a layer
// of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/stacks/named_stack.h"

namespace voxtone::slicer {

struct StackPredictJob {
    std::string stack;  ///< a stack file (.json), or layers as "W 0.3, K 0.1", top first
    NamedStackOptions setting;
    bool check = false;              ///< Monte Carlo beside it
    std::uint32_t paths = 1u << 18;  ///< per layer and channel, >= 2
    std::uint64_t seed = 1;
    std::vector<std::string> files;  ///< to write: .json (voxtone-profile), .svg
    bool overwrite = false;          ///< files that are there are replaced
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_stack_predict(const StackPredictJob& job, Progress& progress);

}  // namespace voxtone::slicer
