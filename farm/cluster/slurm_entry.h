// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job of a plan on its way to Slurm, and how that is told.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/named_values.h"
#include "farm/cluster/submission.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

enum class EntryState {
    left,  ///< to be submitted; of a dry run: would be
    submitted,
    queued,     ///< was submitted before, and waits or runs
    unchanged,  ///< is done
    elsewhere,  ///< another batch works on it
    failed,     ///< cannot be estimated, and so not be sliced
};

struct SlurmEntry {
    PlannedJob job;
    std::size_t number = 0;  ///< in its plan, from 1
    EntryState state = EntryState::left;
    TaskChain chain;
    Submission submission;
    std::string scripts;  ///< of a dry run
    std::string message;
    int exit_code = 0;
};

/// What is said at the end. `last`: number of the job that waits for all; empty: none.
[[nodiscard]] JobResult slurm_result(std::span<const SlurmEntry> entries, const std::filesystem::path& out,
                                     const std::string& last, bool dry_run);

}  // namespace voxtone::farm

template <>
struct voxtone::NamesOf<voxtone::farm::EntryState> {
    using State = farm::EntryState;
    static constexpr auto table = std::to_array<Named<State>>({{State::left, "left"},
                                                               {State::submitted, "submitted"},
                                                               {State::queued, "queued"},
                                                               {State::unchanged, "unchanged"},
                                                               {State::elsewhere, "elsewhere"},
                                                               {State::failed, "failed"}});
};
