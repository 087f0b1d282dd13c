// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory there is for this process: the machine's, or less where a container, a scheduler or a shell allows
// less. What is in use by others is not subtracted.
#pragma once

#include <cstdint>
#include <filesystem>

namespace voxtone {

/// The least of the physical memory, the limits of this process's control groups (memory.max of version 2 and
/// memory.limit_in_bytes of version 1, of the group and those above it), what Slurm says that its job was given
/// (grant.h), and its address space (`ulimit -v`).
[[nodiscard]] std::uint64_t machine_memory_bytes();

/// The same without the address space, which is a limit of its own for every program that is started.
[[nodiscard]] std::uint64_t resident_memory_bytes();

/// The least limit of the control groups that `cgroup` (of the form of /proc/self/cgroup) names, below `mount`
/// (/sys/fs/cgroup). The largest number where none is set.
[[nodiscard]] std::uint64_t cgroup_memory_bytes(const std::filesystem::path& cgroup,
                                                const std::filesystem::path& mount);

}  // namespace voxtone
