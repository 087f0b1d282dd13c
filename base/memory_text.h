// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory, in the unit in which it is allowed (--memory).
#pragma once

#include <cstdint>
#include <string>

#include <fmt/core.h>

namespace voxtone {

/// "1.49 GiB", "812 MiB".
[[nodiscard]] inline std::string memory_text(std::uint64_t bytes) {
    constexpr double mib = 1 << 20, mib_per_gib = 1024;
    const double amount = static_cast<double>(bytes) / mib;
    return amount < mib_per_gib ? fmt::format("{:.0f} MiB", amount) : fmt::format("{:.2f} GiB", amount / mib_per_gib);
}

}  // namespace voxtone
