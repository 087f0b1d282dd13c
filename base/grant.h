// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scheduler gave this process of its machine. Where it binds its jobs to cores and puts them into control groups
// the system says so itself; where it does not, only its word keeps jobs from crowding one another out.
#pragma once

#include <cstddef>
#include <cstdint>

namespace voxtone {

/// The least of `seen`, the cores that the system shows, and what Slurm says that a task of its job may use:
/// SLURM_CPUS_PER_TASK, or SLURM_CPUS_ON_NODE where that is not set. At least 1.
[[nodiscard]] std::size_t granted_cores(std::size_t seen);

/// SLURM_MEM_PER_NODE, or SLURM_MEM_PER_CPU times SLURM_CPUS_ON_NODE, which are in MiB. The largest number where none
/// is set, or 0, which is Slurm's word for all of the node.
[[nodiscard]] std::uint64_t granted_memory_bytes();

}  // namespace voxtone
