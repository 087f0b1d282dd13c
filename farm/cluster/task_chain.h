// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job as tasks for the machines of a cluster: which commands, in which order, and what each is to be given. It knows
// no scheduler; slurm_*.h makes arrays of it.
//
//   whole              the job as it is: where it is not cut
//   prepare            the appearance loop, once: where there is one and the job is cut
//   layers             shards of the layers, in any order, at once, anywhere
//   merge              one stack of them, and its report
//
// All tasks of a stage need all of the stage before it. Every task may be run again, and twice at once (docs/batch.md,
// "Shards and merge"). What they are given comes from the estimate's phases (print/job_estimate.h):
//   memory   the most of the stage's phases, an eighth more, and 64 MB for what starts it
//   time     three times the sum of its phases on its cores, and ten minutes more
//   cores    so many that each has a minute's work: 1, 2, 4, 8, ... up to what is allowed
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/named_values.h"
#include "farm/batch/plan.h"
#include "slicer/print/job_estimate.h"

namespace voxtone::farm {

enum class TaskStage { whole, prepare, layers, merge };

struct ChainOptions {
    int most_cores = 8;    ///< of a task; a job that says --threads takes that
    int shards = 0;        ///< of every job that can be cut; 0: by the estimate, 1: none is cut
    double shard_s = 600;  ///< by the estimate: so many shards that each takes no longer on its cores
    int most_shards = 1000;
};

/// The equal tasks of one stage.
struct ChainStage {
    TaskStage stage = TaskStage::whole;
    std::vector<std::string>
        arguments;  ///< behind `voxtone`, all but `--shard`: those of task I are arguments_of(stage, I)
    int tasks = 1;  ///< 1, or the number of shards
    int cores = 1;
    std::uint64_t memory_bytes = 0;  ///< of a task; not below what it takes
    bool is_raised = false;          ///< above the estimate, for it was too little before (stage_memory.h)
    double expected_s = 0;           ///< of wall clock, for a task on its cores
    double limit_s = 0;              ///< what it may take before it is to be stopped
};

struct TaskChain {
    std::vector<ChainStage> stages;  ///< one: {whole}; or two or three
    int shards = 1;
    double cpu_s = 0;         ///< of processors, for the whole job
    std::string why_whole{};  ///< a sentence, where shards were asked for and the job cannot be cut; else empty
};

/// `estimate`: of this job (estimate_job). Reads no model. Throws UsageError, InputError, FileError as opening the job
/// does.
[[nodiscard]] TaskChain task_chain(const PlannedJob& job, const slicer::JobEstimate& estimate,
                                   const ChainOptions& options);

/// The words behind `voxtone` of task `index` of the stage, from 1: for layers with its `--shard index/tasks`.
[[nodiscard]] std::vector<std::string> arguments_of(const ChainStage& stage, int index);

/// The job as all of its tasks do it, wherever they run: with the memory for loop, prediction and reading that it would
/// allow itself here. A task is given no more than it needs, and half of that, which is what a job allows itself where
/// nothing is said, might cut a loop otherwise or refuse a model.
[[nodiscard]] slicer::SliceOptions options_on_cluster(const slicer::SliceOptions& options);

/// That `options_on_cluster` says a memory that is this machine's, for whoever hands these jobs over; empty: it says
/// none.
[[nodiscard]] std::string note_of_memory(std::span<const PlannedJob> jobs);

/// Whether a task that is stopped goes on where it was when it is run again, as the loop does. Others begin anew.
[[nodiscard]] bool keeps_what_it_did(TaskStage stage, const slicer::SliceOptions& options);

}  // namespace voxtone::farm

template <>
struct voxtone::NamesOf<voxtone::farm::TaskStage> {
    using Stage = farm::TaskStage;
    static constexpr auto table = std::to_array<Named<Stage>>(
        {{Stage::whole, "whole"}, {Stage::prepare, "prepare"}, {Stage::layers, "layers"}, {Stage::merge, "merge"}});
};
