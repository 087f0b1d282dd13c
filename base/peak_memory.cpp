// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/peak_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace voxtone {

namespace {

template <class Who>
std::uint64_t peak_of(Who who) {
    rusage usage{};
    getrusage(who, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace

std::uint64_t peak_memory_bytes() { return peak_of(RUSAGE_SELF); }

std::uint64_t resident_bytes() {
    std::uint64_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t peak_child_memory_bytes() { return peak_of(RUSAGE_CHILDREN); }

}  // namespace voxtone
