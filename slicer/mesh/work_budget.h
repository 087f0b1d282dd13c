// SPDX-License-Identifier: GPL-3.0-or-later
//
// A bound on searches whose cost depends on how a mesh lies in itself: most meshes cost a few steps a triangle, a heap
// of triangles in one place costs all pairs of them. Who searches spends steps; who spends more than there are is
// stopped. Whether that happens depends on the sum alone, so it is the same for any number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>

#include "base/progress.h"

namespace voxtone::slicer {

/// More steps were needed than allowed. For those who set the budget, who say what it means to the user.
struct WorkExceeded : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "a search took more steps than it may"; }
};

/// All members may be called from any thread.
class WorkBudget {
public:
    /// Looking at one triangle is one step (some 15 ns), an exact test of two is 16; a pair to be kept costs memory
    /// too.
    static constexpr std::uint64_t exact_test = 16, kept_pair = 48;

    explicit WorkBudget(std::uint64_t steps, const Progress* progress = nullptr) : steps_(steps), progress_(progress) {}
    WorkBudget(const WorkBudget&) = delete;
    WorkBudget& operator=(const WorkBudget&) = delete;

    /// Throws WorkExceeded, and Cancelled when the user asked to stop.
    void spend(std::uint64_t steps) {
        if (progress_) progress_->check_cancelled();
        if (spent_.fetch_add(steps, std::memory_order_relaxed) + steps > steps_) throw WorkExceeded();
    }
    [[nodiscard]] std::uint64_t spent() const { return spent_; }
    [[nodiscard]] const Progress* progress() const { return progress_; }

    /// Half a minute of one core, and more than any body needs for each of its triangles.
    [[nodiscard]] static constexpr std::uint64_t for_triangles(std::size_t triangles) {
        return 2'000'000'000 + 4096 * std::uint64_t{triangles};
    }

private:
    std::uint64_t steps_;
    const Progress* progress_;
    std::atomic<std::uint64_t> spent_{0};
};

}  // namespace voxtone::slicer
