// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plan of a batch: its jobs, checked whole before the first of them starts. Each is one run of `voxtone slice` into
// a folder of its own, OUT/NAME.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "farm/batch/plan_rows.h"
#include "slicer/options/slice_options.h"

namespace voxtone::farm {

struct PlanOptions {
    std::vector<std::string> plan;  ///< as read_plan_rows takes it
    std::string preset;             ///< job file whose options all jobs begin with; empty: none
    std::string name = "{name}";    ///< template of the jobs' names (job_names.h)
    std::filesystem::path out;      ///< OUT
    std::optional<slicer::SliceOptions> begin_with =
        {};  ///< options that all jobs begin with, in the place of a preset
};

struct PlannedJob {
    std::string name;  ///< no other job of the plan has it
    slicer::SliceOptions
        options;  ///< paths are absolute; neither `overwrite` nor `resume`, which are not the plan's to say
    std::vector<std::string> command;  ///< words behind `voxtone`: "slice", ...
    std::filesystem::path out;         ///< absolute
    std::string place;                 ///< where the plan has it, for messages: "plan.csv: line 4"
};

/// The plan's jobs in its order. Every model is there and every option valid: what can refuse a job before its model is
/// read was asked. Changes nothing on disk. Throws InputError that lists every
/// fault with its line, UsageError, FileError, Cancelled.
[[nodiscard]] std::vector<PlannedJob> read_plan(const PlanOptions& options, Progress* progress = nullptr);

/// The same for rows that were found otherwise.
[[nodiscard]] std::vector<PlannedJob> plan_jobs(const PlanRows& rows, const PlanOptions& options,
                                                Progress* progress = nullptr);

}  // namespace voxtone::farm
