// SPDX-License-Identifier: GPL-3.0-or-later
//
// Steps that shards of one body and of a tray have in common: what is there already, and whose the folder is.
#pragma once

#include <optional>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "base/stopwatch.h"
#include "io/shards/shard_folder.h"
#include "slicer/job/slice_report.h"
#include "slicer/prepare/opened_job.h"
#include "slicer/shards/shard_task.h"

namespace voxtone::slicer {

/// Of the record of a shard: shards of two programs do not go together.
[[nodiscard]] std::string shard_program();

/// Which shard is asked for.
[[nodiscard]] ShardTask task_of(const OpenedJob& job, bool same_job_before);

/// Throws UsageError for outputs that are one file of the whole stack.
void expect_shardable(const OpenedJob& job);

[[nodiscard]] JobResult shard_result(const io::ShardRecord& record, const std::filesystem::path& out, const char* what);

/// The same job's stack, whole: what shards are made for.
[[nodiscard]] std::optional<JobResult> merged_before(const OpenedJob& job, const Progress& progress);

/// This very shard, with every file.
[[nodiscard]] std::optional<io::ShardRecord> made_before(const OpenedJob& job, const io::ShardNumber& number);

/// The first of the shards that take a folder over from another job clears it, and no other: those that begin at the
/// same time wait, and then find it theirs.
void claim_folder_for_shards(const OpenedJob& job, io::ShardFolder& folder, const std::string& job_text,
                             const Progress& progress);

[[nodiscard]] io::ShardFigures shard_figures(const JobMeasurements& figures, const Stopwatch& since_begin);

}  // namespace voxtone::slicer
