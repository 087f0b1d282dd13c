// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/base/machine_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "voxtone/base/grant.h"

namespace voxtone {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// The number in a file; "max", and what is no file, are no limit.
std::uint64_t limit_in(const fs::path& file) {
    std::ifstream in(file);
    std::uint64_t bytes = 0;
    return in >> bytes && bytes > 0 ? bytes : unlimited;
}

/// A group's limit holds for those below it; in a container the mount is often the group itself.
std::uint64_t least_up_to(const fs::path& mount, const std::string& group, const char* file) {
    std::uint64_t least = limit_in(mount / file);
    for (fs::path path = fs::path(group).relative_path(); !path.empty(); path = path.parent_path())
        least = std::min(least, limit_in(mount / path / file));
    return least;
}

}  // namespace

std::uint64_t cgroup_memory_bytes(const fs::path& cgroup, const fs::path& mount) {
    std::uint64_t least = unlimited;
    std::ifstream in(cgroup);
    for (std::string line; std::getline(in, line);) {  // NUMBER:CONTROLLERS:/GROUP
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        std::string controllers(",");
        controllers.append(line, first + 1, second - first - 1).append(",");
        const std::string group = line.substr(second + 1);
        if (controllers == ",,") least = std::min(least, least_up_to(mount, group, "memory.max"));
        if (controllers.find(",memory,") != std::string::npos)
            least = std::min(least, least_up_to(mount / "memory", group, "memory.limit_in_bytes"));
    }
    return least;
}

std::uint64_t resident_memory_bytes() {
    const std::uint64_t physical =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    return std::min({physical, cgroup_memory_bytes("/proc/self/cgroup", "/sys/fs/cgroup"), granted_memory_bytes()});
}

std::uint64_t machine_memory_bytes() {
    rlimit space{};
    const bool limited = getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
    return std::min(resident_memory_bytes(), limited ? static_cast<std::uint64_t>(space.rlim_cur) : unlimited);
}

}  // namespace voxtone
