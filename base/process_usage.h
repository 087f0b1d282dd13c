// SPDX-License-Identifier: GPL-3.0-or-later
//
// What this process has taken of the machine, as the system counts it.
#pragma once

#include <cstdint>

namespace voxtone {

/// The most memory that this process has held at once since it began (resident set).
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// What it holds now; 0 where the system does not say.
[[nodiscard]] std::uint64_t resident_bytes();

/// The most of the largest program that it has run to its end.
[[nodiscard]] std::uint64_t peak_child_memory_bytes();

/// Seconds that processors have worked for this process since it began, summed over its threads, and for the programs
/// that it has run to their end.
[[nodiscard]] double cpu_seconds();

}  // namespace voxtone
