// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ways to print a target that are compared: sets of options of `slice`, in one place; and one print.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "slicer/options/slice_options.h"

namespace voxtone::loop_benchmark {

using OptionSet = std::vector<std::pair<std::string, std::string>>;  ///< key and value, as `slice` has them

struct Variant {
    std::string name;
    OptionSet set;
};

/// Open loop, then the loop. `loop`: options of the loop besides.
[[nodiscard]] std::vector<Variant> variants(const OptionSet& loop);

/// Applies a set. Throws UsageError for a key that `slice` does not have.
void set_options(const OptionSet& set, slicer::SliceOptions& options);

/// "key=value" each. Throws UsageError.
[[nodiscard]] OptionSet parse_set(const std::vector<std::string>& texts);

struct Print {
    slicer::SliceOptions options;
    double seconds = 0, core_seconds = 0;
    int iterations = -1;  ///< of the loop, as the report says; -1: it says nothing
};

/// Slices into options.out; everything but the prediction for the report. A folder that holds a finished print of the
/// same options is taken as it is where `reuse`.
[[nodiscard]] Print make_print(const slicer::SliceOptions& options, bool reuse);

}  // namespace voxtone::loop_benchmark
