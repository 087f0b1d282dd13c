// SPDX-License-Identifier: GPL-3.0-or-later
//
// A share of a stage's steps, spread over tasks whose number is known, or guessed.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "base/progress.h"

namespace voxtone::slicer {

class StepShare {
public:
    /// `progress` may be null.
    StepShare(Progress* progress, std::uint64_t steps, std::uint64_t tasks)
        : progress_(progress), steps_(steps), tasks_(std::max<std::uint64_t>(tasks, 1)) {}
    StepShare(const StepShare&) = delete;
    StepShare& operator=(const StepShare&) = delete;

    /// So many tasks are done; those beyond the last are passed over. From any thread.
    void advance(std::uint64_t tasks = 1) {
        const std::uint64_t before = done_.fetch_add(tasks);
        const std::uint64_t from = std::min(before, tasks_), to = std::min(before + tasks, tasks_);
        if (progress_ && to > from) progress_->advance(steps_ * to / tasks_ - steps_ * from / tasks_);
    }
    /// Whatever is left of the share.
    void finish() { advance(tasks_); }

private:
    Progress* progress_;
    std::uint64_t steps_, tasks_;
    std::atomic<std::uint64_t> done_{0};
};

}  // namespace voxtone::slicer
