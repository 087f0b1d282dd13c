// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one door to TBB. Exceptions thrown by a body stop the loop and reach the caller; cancellation is checked before
// every chunk. No result may depend on the order or the number of threads: bodies write to places that they own.
//
// The thread sanitizer does not see into TBB, and takes the work that it hands from thread to thread for races. Under
// it threads of the standard library do the work, and no two bodies are ordered but those of which one waits for the
// other.
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
#include <exception>
#include <mutex>
#include <thread>
#endif

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

#ifdef __SANITIZE_THREAD__

/// Calls `work` on every thread, on this one alone within another such call. The first exception is thrown here.
template <class Work>
void on_plain_threads(Work&& work) {
    static thread_local bool within = false;
    std::exception_ptr failure;
    std::mutex mutex;
    const auto run = [&] {
        const bool nested = std::exchange(within, true);
        try {
            work();
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (!failure) failure = std::current_exception();
        }
        within = nested;
    };
    std::vector<std::thread> others;
    for (std::size_t thread = 1; !within && thread < thread_count(); ++thread) others.emplace_back(run);
    run();
    for (std::thread& other : others) other.join();
    if (failure) std::rethrow_exception(failure);
}

#endif

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
#ifdef __SANITIZE_THREAD__
    std::atomic<std::size_t> next = begin;
    on_plain_threads([&] {
        for (std::size_t first; (first = next.fetch_add(grain, std::memory_order_relaxed)) < end;) try {
                if (progress) progress->check_cancelled();
                body(first, std::min(first + grain, end));
            } catch (...) {
                next.store(end, std::memory_order_relaxed);
                throw;
            }
    });
#else
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          if (progress) progress->check_cancelled();
                          body(range.begin(), range.end());
                      });
#endif
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
    std::sort(values.begin(), values.end());
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
#ifdef __SANITIZE_THREAD__
    std::vector<std::atomic<std::int64_t>> order(
        followers.size());  // the tasks as they become ready; -1: not yet known
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k < ready.size() ? std::int64_t(ready[k]) : -1;
    std::atomic<std::size_t> known = ready.size(), taken = 0;
    std::atomic<bool> failed = false;
    on_plain_threads([&] {
        for (std::size_t k; (k = taken.fetch_add(1, std::memory_order_relaxed)) < order.size();) try {
                std::int64_t i;
                while ((i = order[k].load(std::memory_order_acquire)) < 0) {
                    if (failed.load(std::memory_order_relaxed)) return;
                    std::this_thread::yield();
                }
                body(std::uint32_t(i));
                for (const std::uint32_t next : followers[std::size_t(i)])
                    if (waits[next].fetch_sub(1, std::memory_order_acq_rel) == 1)
                        order[known.fetch_add(1, std::memory_order_relaxed)].store(next, std::memory_order_release);
            } catch (...) {
                failed.store(true, std::memory_order_relaxed);
                throw;
            }
    });
#else
    tbb::parallel_for_each(ready.begin(), ready.end(), [&](std::uint32_t i, tbb::feeder<std::uint32_t>& feeder) {
        body(i);
        for (const std::uint32_t next : followers[i])
            if (waits[next].fetch_sub(1, std::memory_order_acq_rel) == 1) feeder.add(next);
    });
#endif
}

}  // namespace voxtone
