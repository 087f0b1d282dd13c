// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one door to TBB. Exceptions thrown by a body stop the loop and reach the caller; cancellation is checked before
// every chunk. No result may depend on the order or the number of threads: bodies write to places that they own.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_for_each.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/progress.h"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace voxtone {

// What the thread sanitizer cannot see: TBB hands work from thread to thread in a library that was not compiled with
// it. A loop's bodies know what its caller wrote before, and the caller knows what they wrote; of bodies among
// themselves nothing is said, so that their races are found. Without the sanitizer this is nothing.
#ifdef __SANITIZE_THREAD__

class LoopFences {
public:
    LoopFences() { __tsan_release(&begun_); }
    ~LoopFences() { __tsan_acquire(&ended_); }
    LoopFences(const LoopFences&) = delete;
    LoopFences& operator=(const LoopFences&) = delete;
    void enter() { __tsan_acquire(&begun_); }
    void leave() { __tsan_release(&ended_); }

private:
    char begun_ = 0, ended_ = 0;  ///< places that stand for the two moments
};

#else

struct LoopFences {
    void enter() {}
    void leave() {}
};

#endif

/// A body's part of a loop, from its construction to its end.
class LoopBody {
public:
    explicit LoopBody(LoopFences& fences) : fences_(fences) { fences_.enter(); }
    ~LoopBody() { fences_.leave(); }
    LoopBody(const LoopBody&) = delete;
    LoopBody& operator=(const LoopBody&) = delete;

private:
    LoopFences& fences_;
};

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
    LoopFences fences;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          const LoopBody within(fences);
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

/// Sorts with `<`, which must order all values: then the result is the same for any number of threads.
template <class Value>
void parallel_sort(std::span<Value> values) {
#ifdef __SANITIZE_THREAD__
    std::sort(values.begin(), values.end());  // TBB's own steps would look like races (see above)
#else
    tbb::parallel_sort(values.begin(), values.end());
#endif
}

/// Tasks of which some wait for others: calls body(i) for every i below `followers.size()`, once all tasks that have i
/// among their followers are done. A follower stands once for each task that it waits for; no task waits for itself
/// through others.
template <class Followers, class Body>
void parallel_graph(std::span<const Followers> followers, Body&& body) {
    std::vector<std::atomic<std::uint32_t>> waits(followers.size());
    for (const Followers& of : followers)
        for (const std::uint32_t next : of) waits[next].fetch_add(1, std::memory_order_relaxed);
    std::vector<std::uint32_t> ready;
    for (std::uint32_t i = 0; i < waits.size(); ++i)
        if (waits[i].load(std::memory_order_relaxed) == 0) ready.push_back(i);
    LoopFences fences;
    tbb::parallel_for_each(ready.begin(), ready.end(), [&](std::uint32_t i, tbb::feeder<std::uint32_t>& feeder) {
        const LoopBody within(fences);
        (void)waits[i].load(std::memory_order_acquire);  // what the tasks that this one waited for have written
        body(i);
        for (const std::uint32_t next : followers[i])
            if (waits[next].fetch_sub(1, std::memory_order_acq_rel) == 1) feeder.add(next);
    });
}

}  // namespace voxtone
