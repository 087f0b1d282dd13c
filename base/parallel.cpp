// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/base/parallel.h"

#include <oneapi/tbb/info.h>

#include "voxtone/base/grant.h"

namespace voxtone {

namespace {
std::size_t resolved(std::size_t threads) {
    return threads ? threads : granted_cores(static_cast<std::size_t>(tbb::info::default_concurrency()));
}
}  // namespace

ThreadLimit::ThreadLimit(std::size_t threads)
    : control_(tbb::global_control::max_allowed_parallelism, resolved(threads)) {}

std::size_t thread_count() { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); }

}  // namespace voxtone
