// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/base/peak_memory.h"

#include <sys/resource.h>

namespace voxtone {

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace voxtone
