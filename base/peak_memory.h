// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace voxtone {

/// The most memory that this process has held at once since it began, as the system counts it (resident set).
[[nodiscard]] std::uint64_t peak_memory_bytes();

}  // namespace voxtone
