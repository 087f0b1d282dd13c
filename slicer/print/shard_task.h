// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which shard a task of a scheduler is to make, where the user leaves that to the scheduler (`--shard` alone).
//
// A Slurm array says SLURM_ARRAY_TASK_ID, _MIN, _COUNT. A whole array numbers its shards from its first task on. An
// array of what was missing (`--array=3,7-9`) has other numbers, so it goes by the shards that are there already: into
// how many the job was cut, and which task the first one was.
#pragma once

#include <filesystem>

#include "io/shards/shard_number.h"

namespace voxtone::slicer {

struct ShardTask {
    io::ShardNumber number;
    std::uint32_t first_task = 1;  ///< the scheduler's number of shard 1
};

/// `shards`: the output folder, where it holds shards of this very job; empty: none. Throws UsageError where this is no
/// task of an array, or cannot be numbered.
[[nodiscard]] ShardTask task_of_scheduler(const std::filesystem::path& shards);

}  // namespace voxtone::slicer
