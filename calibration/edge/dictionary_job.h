// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate edge dictionary`: traces the runs of a dictionary (edge_dictionary.h) into a file, whole or as a
// shard, and puts shards together.
//
// Every finished run is appended to OUT.partial at once; the same command goes on where that ended. The finished file
// has its records in the grid's order: the same bits, however often it was stopped and for any number of threads.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/edge/edge_dictionary.h"

namespace voxtone::calibration {

struct DictionaryJob {
    std::string setup;  ///< setup.json; empty: the defaults
    EdgeGrid grid;      ///< without extinctions: the paper's
    std::size_t shard = 1, shards = 1;
    std::vector<std::string> merge;  ///< files to put together instead of tracing
    bool estimate = false;           ///< only says what it would take, from one run in twenty with few paths
    std::string out;
    bool overwrite = false;

    /// Throws UsageError or InputError that names the option and the rule.
    void validate() const;
};

[[nodiscard]] JobResult run_dictionary_job(const DictionaryJob& job, Progress& progress);

}  // namespace voxtone::calibration
