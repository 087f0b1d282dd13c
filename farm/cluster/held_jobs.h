// SPDX-License-Identifier: GPL-3.0-or-later
//
// Jobs that wait in Slurm's queue and will not begin until somebody lets them: held by their user, by an administrator,
// or by Slurm (RequeueExitHold, a launch that failed).
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "farm/cluster/slurm_commands.h"
#include "farm/cluster/submission.h"

namespace voxtone::farm {

/// What is to be said of a submission; empty: nothing of it is held.
[[nodiscard]] std::string hold_text(const Submission& submission, const SlurmQueue& queue);

/// The same for the jobs of a batch that are not done, by name, where Slurm answers; it is asked only where something
/// was handed to it. Throws InputError, FileError for what is no batch's folder.
[[nodiscard]] std::map<std::string, std::string> held_jobs(const std::filesystem::path& out);

}  // namespace voxtone::farm
