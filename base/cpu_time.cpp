// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/cpu_time.h"

#include <sys/resource.h>

#include <initializer_list>

namespace voxtone {

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
