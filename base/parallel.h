// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one door to TBB, which itself is included by parallel.cpp alone (and optics/numerics/parallel_sort.h): what a
// loop does is handed over as a pointer that is called once a chunk. Exceptions thrown by a body stop the loop and
// reach the caller; cancellation is checked before every chunk. No result may depend on the order or the number of
// threads: bodies write to places that they own.
//
// The thread sanitizer does not see into TBB, and takes the work that it hands from thread to thread for races. Under
// it threads of the standard library do the work, and no two bodies are ordered but those of which one waits for the
// other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "base/progress.h"

namespace voxtone {

/// Limits the number of threads while it lives; 0 means one per core that this process was given (control_group.h).
class ThreadLimit {
public:
    explicit ThreadLimit(std::size_t threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Threads that parallel loops use now.
[[nodiscard]] std::size_t thread_count();

/// A function of some arguments that somebody else owns and that outlives the call it is handed to.
template <class... Arguments>
class BorrowedFunction {
public:
    template <class Function>
    requires(!std::is_same_v<std::remove_cvref_t<Function>, BorrowedFunction>)
        BorrowedFunction(Function&& function)  // NOLINT(google-explicit-constructor): stands where a function stands
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
          call_([](void* object, Arguments... arguments) {
              (*static_cast<std::remove_reference_t<Function>*>(object))(arguments...);
          }) {}
    void operator()(Arguments... arguments) const { call_(object_, arguments...); }

private:
    void* object_;
    void (*call_)(void*, Arguments...);
};

/// Calls body(first, last) for disjoint ranges that cover [begin, end); ranges shorter than `grain` are not split.
void parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain,
                     BorrowedFunction<std::size_t, std::size_t> body, const Progress* progress = nullptr);

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

/// Task i of parallel_graph is done: `released(next)` is to be called for each that follows on it.
using Release = BorrowedFunction<std::uint32_t>;
/// Tasks of which task i waits for `waits[i]` others: run(i, released) once these are done.
void parallel_tasks(std::vector<std::uint32_t> waits, BorrowedFunction<std::uint32_t, const Release&> run);

/// Tasks of which some wait for others: calls body(i) for every i below `followers.size()`, once all tasks that have i
/// among their followers are done. A follower stands once for each task that it waits for; no task waits for itself
/// through others.
template <class Followers, class Body>
void parallel_graph(std::span<const Followers> followers, Body&& body) {
    std::vector<std::uint32_t> waits(followers.size());
    for (const Followers& of : followers)
        for (const std::uint32_t next : of) ++waits[next];
    parallel_tasks(std::move(waits), [&](std::uint32_t i, const Release& released) {
        body(i);
        for (const std::uint32_t next : followers[i]) released(next);
    });
}

}  // namespace voxtone
