// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_for_each.h>

#include "base/control_group.h"

#ifdef __SANITIZE_THREAD__
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#endif

namespace voxtone {

namespace {

/// What the system shows, less what a container's quota takes away: more threads than that would wait for one another.
std::size_t cores_here() {
    const auto shown = static_cast<double>(tbb::info::default_concurrency());
    return static_cast<std::size_t>(std::max(1.0, std::min(shown, std::ceil(cgroup_cores()))));
}

std::size_t resolved(std::size_t threads) { return threads ? threads : granted_cores(cores_here()); }

using Counters = std::vector<std::atomic<std::uint32_t>>;

/// One task less that `next` waits for; whether it was the last.
bool waits_no_more(Counters& waits, std::uint32_t next) {
    return waits[next].fetch_sub(1, std::memory_order_acq_rel) == 1;
}

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

void split(std::size_t begin, std::size_t end, std::size_t grain, BorrowedFunction<std::size_t, std::size_t> body) {
    std::atomic<std::size_t> next = begin;
    on_plain_threads([&] {
        for (std::size_t first; (first = next.fetch_add(grain, std::memory_order_relaxed)) < end;) try {
                body(first, std::min(first + grain, end));
            } catch (...) {
                next.store(end, std::memory_order_relaxed);
                throw;
            }
    });
}

void run_graph(const std::vector<std::uint32_t>& ready, Counters& waits,
               BorrowedFunction<std::uint32_t, const Release&> run) {
    std::vector<std::atomic<std::int64_t>> order(waits.size());  // the tasks as they become ready; -1: not yet known
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k < ready.size() ? std::int64_t(ready[k]) : -1;
    std::atomic<std::size_t> known = ready.size(), taken = 0;
    std::atomic<bool> failed = false;
    const auto released = [&](std::uint32_t next) {
        if (waits_no_more(waits, next))
            order[known.fetch_add(1, std::memory_order_relaxed)].store(next, std::memory_order_release);
    };
    on_plain_threads([&] {
        for (std::size_t k; (k = taken.fetch_add(1, std::memory_order_relaxed)) < order.size();) try {
                std::int64_t i;
                while ((i = order[k].load(std::memory_order_acquire)) < 0) {
                    if (failed.load(std::memory_order_relaxed)) return;
                    std::this_thread::yield();
                }
                run(std::uint32_t(i), Release(released));
            } catch (...) {
                failed.store(true, std::memory_order_relaxed);
                throw;
            }
    });
}

#else

void split(std::size_t begin, std::size_t end, std::size_t grain, BorrowedFunction<std::size_t, std::size_t> body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

void run_graph(const std::vector<std::uint32_t>& ready, Counters& waits,
               BorrowedFunction<std::uint32_t, const Release&> run) {
    tbb::parallel_for_each(ready.begin(), ready.end(), [&](std::uint32_t i, tbb::feeder<std::uint32_t>& feeder) {
        const auto released = [&](std::uint32_t next) {
            if (waits_no_more(waits, next)) feeder.add(next);
        };
        run(i, Release(released));
    });
}

#endif

}  // namespace

struct ThreadLimit::Control {
    tbb::global_control limit;
};

ThreadLimit::ThreadLimit(std::size_t threads)
    : control_(new Control{{tbb::global_control::max_allowed_parallelism, resolved(threads)}}) {}
ThreadLimit::~ThreadLimit() = default;

std::size_t thread_count() { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); }

void parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain,
                     BorrowedFunction<std::size_t, std::size_t> body, const Progress* progress) {
    if (end <= begin) return;
    grain = std::max<std::size_t>(grain, 1);
    const auto checked = [&](std::size_t first, std::size_t last) {
        if (progress) progress->check_cancelled();
        body(first, last);
    };
    if (end - begin <= grain)
        checked(begin, end);
    else
        split(begin, end, grain, checked);
}

void parallel_tasks(std::vector<std::uint32_t> waits, BorrowedFunction<std::uint32_t, const Release&> run) {
    Counters counters(waits.size());
    std::vector<std::uint32_t> ready;
    for (std::uint32_t i = 0; i < waits.size(); ++i) {
        counters[i].store(waits[i], std::memory_order_relaxed);
        if (waits[i] == 0) ready.push_back(i);
    }
    run_graph(ready, counters, run);
}

}  // namespace voxtone
