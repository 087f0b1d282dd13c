// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slurm, asked by its own commands: scontrol, sbatch, squeue, scancel, as they are found in PATH.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace voxtone::slicer {

struct SlurmConfig {
    std::uint32_t max_array_size = 1001;  ///< numbers of an array's tasks are below it; 0: there are no arrays
};

/// Of the cluster that this machine belongs to. Throws FileError where Slurm is not on this machine, TryAgain where its
/// controller does not answer.
[[nodiscard]] SlurmConfig slurm_config();

/// Numbers of the jobs that wait or run, whoever submitted them; an array's is that of all of its tasks. Throws
/// FileError, TryAgain.
[[nodiscard]] std::set<std::string> slurm_queue();

/// `words`: behind `sbatch --parsable`. The job's number. Throws InputError that gives what sbatch said, TryAgain where
/// it may accept the same another time.
[[nodiscard]] std::string submit_to_slurm(std::span<const std::string> words);

/// What cannot be cancelled, as it has ended, is left.
void cancel_in_slurm(const std::vector<std::string>& numbers);

/// The job that this process runs in: "17", or "17_3" for a task of an array, whose own number may be the whole array's
/// too. Empty: in none.
[[nodiscard]] std::string own_slurm_job();
/// How often that job was put back into the queue before.
[[nodiscard]] int own_slurm_restarts();
/// Puts it back: false where Slurm refuses. Slurm ends this process soon after.
[[nodiscard]] bool requeue_in_slurm(const std::string& job);

}  // namespace voxtone::slicer
