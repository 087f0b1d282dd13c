// SPDX-License-Identifier: GPL-3.0-or-later
//
// What containers and schedulers allow a process by Linux's control groups, of version 1 and 2: the least limit of the
// groups that `cgroup` (of the form of /proc/self/cgroup) names and of those above them, below `mount`
// (/sys/fs/cgroup). Where a scheduler does not bind its jobs by them, only its word keeps jobs from crowding one
// another out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace voxtone {

/// memory.max, memory.high (above it the kernel slows processes down), memory.limit_in_bytes. The largest number where
/// none is set.
[[nodiscard]] std::uint64_t cgroup_memory_bytes(const std::filesystem::path& cgroup = "/proc/self/cgroup",
                                                const std::filesystem::path& mount = "/sys/fs/cgroup");

/// Processors' time a second of the clock (cpu.max; cpu.cfs_quota_us over cpu.cfs_period_us). Infinity where none is
/// set.
[[nodiscard]] double cgroup_cores(const std::filesystem::path& cgroup = "/proc/self/cgroup",
                                  const std::filesystem::path& mount = "/sys/fs/cgroup");

/// How many processes of this process's own group the kernel has killed for memory so far (oom_kill in memory.events,
/// memory.oom_control). 0 where that is not told.
[[nodiscard]] std::uint64_t cgroup_oom_kills(const std::filesystem::path& cgroup = "/proc/self/cgroup",
                                             const std::filesystem::path& mount = "/sys/fs/cgroup");

/// The least of `seen`, the cores that the system shows, and what Slurm says that a task of its job may use:
/// SLURM_CPUS_PER_TASK, or SLURM_CPUS_ON_NODE where that is not set. At least 1.
[[nodiscard]] std::size_t granted_cores(std::size_t seen);

/// SLURM_MEM_PER_NODE, or SLURM_MEM_PER_CPU times SLURM_CPUS_ON_NODE, which are in MiB. The largest number where none
/// is set, or 0, which is Slurm's word for all of the node.
[[nodiscard]] std::uint64_t granted_memory_bytes();

}  // namespace voxtone
