// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/read_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"

namespace voxtone::io {

std::uint64_t default_read_memory() { return std::min(resident_memory_bytes() / 2, std::uint64_t{8} << 30); }

void validate(const ReadOptions& options) {
    if (!(options.timeout_s > 0) || !std::isfinite(options.timeout_s))
        throw UsageError(
            fmt::format("the time to read a file must be a positive number of seconds, not {}", options.timeout_s));
    if (options.max_pixels == 0 || options.max_pixels > (std::uint64_t{1} << 32))
        throw UsageError(fmt::format("the limit of pixels must be between 1 and 2^32, not {}", options.max_pixels));
}

IsolationLimits isolation_limits(const ReadOptions& options) {
    return {.memory_bytes = options.memory_bytes, .timeout_s = options.timeout_s, .more = options.more};
}

}  // namespace voxtone::io
