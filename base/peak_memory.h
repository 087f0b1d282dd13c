// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace voxtone {

/// The most memory that this process has held at once since it began, as the system counts it (resident set).
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// What it holds now; 0 where the system does not say.
[[nodiscard]] std::uint64_t resident_bytes();

/// The most of the largest program that it has run to its end.
[[nodiscard]] std::uint64_t peak_child_memory_bytes();

}  // namespace voxtone
