// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory there is for this process: the machine's, or less where a container, a scheduler or a shell allows
// less. What is in use by others is not subtracted.
#pragma once

#include <cstdint>
#include <string>

namespace voxtone {

/// The least of the physical memory, the limits of this process's control groups (control_group.h), what Slurm says
/// that its job was given (control_group.h), and its address space (`ulimit -v`).
[[nodiscard]] std::uint64_t machine_memory_bytes();

/// The same without the address space, which is a limit of its own for every program that is started.
[[nodiscard]] std::uint64_t resident_memory_bytes();

/// In the unit in which it is allowed (--memory): "1.49 GiB", "812 MiB".
[[nodiscard]] std::string memory_text(std::uint64_t bytes);

}  // namespace voxtone
