// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/info.h>

#include "base/control_group.h"
#include "base/grant.h"

namespace voxtone {

namespace {
/// What the system shows, less what a container's quota takes away: more threads than that would wait for one another.
std::size_t cores_here() {
    const auto shown = static_cast<double>(tbb::info::default_concurrency());
    return static_cast<std::size_t>(std::max(1.0, std::min(shown, std::ceil(cgroup_cores()))));
}

std::size_t resolved(std::size_t threads) { return threads ? threads : granted_cores(cores_here()); }
}  // namespace

ThreadLimit::ThreadLimit(std::size_t threads)
    : control_(tbb::global_control::max_allowed_parallelism, resolved(threads)) {}

std::size_t thread_count() { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); }

}  // namespace voxtone
