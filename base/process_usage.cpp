// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process_usage.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <initializer_list>

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

double cpu_seconds() {
    constexpr double s_per_us = 1e-6;
    double seconds = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        for (const timeval& time : {usage.ru_utime, usage.ru_stime})
            seconds += double(time.tv_sec) + s_per_us * double(time.tv_usec);
    }
    return seconds;
}

}  // namespace voxtone
