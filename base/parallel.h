// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one door to TBB. Exceptions thrown by a body stop the loop and reach the caller; cancellation is checked before
// every chunk. No result may depend on the order or the number of threads: bodies write to places that they own.
#pragma once

#include <cstddef>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include "voxtone/base/progress.h"

namespace voxtone {

/// Limits the number of threads while it lives; 0 means one per core that this process was given (grant.h).
class ThreadLimit {
public:
    explicit ThreadLimit(std::size_t threads);

private:
    tbb::global_control control_;
};

/// Threads that parallel loops use now.
[[nodiscard]] std::size_t thread_count();

/// Calls body(first, last) for disjoint ranges that cover [begin, end); ranges shorter than `grain` are not split.
template <class Body>
void parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain, Body&& body,
                     const Progress* progress = nullptr) {
    if (end <= begin) return;
    if (grain == 0) grain = 1;
    if (end - begin <= grain) {
        if (progress) progress->check_cancelled();
        body(begin, end);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          if (progress) progress->check_cancelled();
                          body(range.begin(), range.end());
                      });
}

/// Calls body(i) for every i in [begin, end).
template <class Body>
void parallel_for(std::size_t begin, std::size_t end, std::size_t grain, Body&& body,
                  const Progress* progress = nullptr) {
    parallel_ranges(
        begin, end, grain,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) body(i);
        },
        progress);
}

}  // namespace voxtone
