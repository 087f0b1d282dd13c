// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slurm, asked by its own commands: scontrol, sbatch, squeue, scancel, as they are found in PATH.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace voxtone::farm {

struct SlurmConfig {
    std::uint32_t max_array_size = 1001;  ///< numbers of an array's tasks are below it; 0: there are no arrays
};

/// Of the cluster that this machine belongs to. Throws FileError where Slurm is not on this machine, TryAgain where its
/// controller does not answer.
[[nodiscard]] SlurmConfig slurm_config();

/// This user's jobs that wait or run, by their numbers; an array's is that of all of its tasks.
struct SlurmQueue {
    std::set<std::string> numbers;
    std::map<std::string, std::string> held;  ///< those that wait until they are released, with Slurm's reason
};
/// Of others' jobs nothing is asked: a site may have a hundred thousand. Throws FileError, TryAgain.
[[nodiscard]] SlurmQueue slurm_queue();

/// Whether Slurm's word for the end of a job, or of a task of an array, is OUT_OF_MEMORY; false too where it does not
/// know it any more.
[[nodiscard]] bool ended_out_of_memory(const std::string& number);

/// `arguments`: behind `sbatch --parsable`. The job's number. Throws InputError that gives what sbatch said, TryAgain
/// where it may accept the same another time.
[[nodiscard]] std::string submit_to_slurm(std::span<const std::string> arguments);

/// What cannot be cancelled, as it has ended, is left.
void cancel_in_slurm(const std::vector<std::string>& numbers);

/// The job of Slurm that this process runs in, whoever submitted it.
struct SlurmAllocation {
    std::string number;  ///< as sbatch said it; of an array, that of all of its tasks. Empty: it runs in none
    std::string task;    ///< of this process alone: "17", or "17_3"
    int restarts = 0;    ///< how often it was put back into the queue
};
[[nodiscard]] SlurmAllocation own_slurm_allocation();

struct SlurmTime {
    double left_s = 0, limit_s = 0;
};
/// What a task that runs has of its time; nothing: it has no limit, or Slurm does not say.
[[nodiscard]] std::optional<SlurmTime> slurm_time(const std::string& task);
/// Whether somebody takes the task out while it has time left (scancel, scontrol requeue). One that puts itself back
/// then is in the queue again, cancelled or not.
[[nodiscard]] bool is_taken_out_of_slurm(const std::string& task);
/// Puts the task back: false where Slurm refuses. Slurm ends its processes soon after.
[[nodiscard]] bool requeue_in_slurm(const std::string& task);

}  // namespace voxtone::farm
