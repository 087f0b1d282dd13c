// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/machine_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include <fmt/core.h>

#include "base/control_group.h"

namespace voxtone {

namespace {

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

}  // namespace

std::uint64_t resident_memory_bytes() {
    const std::uint64_t physical =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    return std::min({physical, cgroup_memory_bytes(), granted_memory_bytes()});
}

std::uint64_t machine_memory_bytes() {
    rlimit space{};
    const bool limited = getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
    return std::min(resident_memory_bytes(), limited ? static_cast<std::uint64_t>(space.rlim_cur) : no_limit);
}

std::string memory_text(std::uint64_t bytes) {
    constexpr double mib = 1 << 20, mib_per_gib = 1024;
    const double amount = static_cast<double>(bytes) / mib;
    if (bytes < (std::uint64_t{1} << 20)) return fmt::format("{} KiB", (bytes + 1023) / 1024);
    return amount < mib_per_gib ? fmt::format("{:.0f} MiB", amount) : fmt::format("{:.2f} GiB", amount / mib_per_gib);
}

}  // namespace voxtone
