// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which jobs of a batch run now: as many as cores and memory allow. A job is given as many threads as there are cores
// for each of those that could run beside it: many jobs with one thread each finish sooner than one after the other
// with all threads.
#pragma once

#include <memory>
#include <vector>

#include "farm/batch/queued_job.h"

namespace voxtone::farm {

class BatchQueue {
public:
    explicit BatchQueue(BatchContext& context);
    BatchQueue(const BatchQueue&) = delete;
    BatchQueue& operator=(const BatchQueue&) = delete;

    void add(PlannedJob job);
    /// In the place of one of the same name that has ended. False: that has not, and nothing was done.
    [[nodiscard]] bool add_or_replace(const PlannedJob& job);
    /// How many jobs have ended since the beginning, whatever came in their place.
    [[nodiscard]] std::size_t ended() const;
    /// Looks at what runs and starts what fits. False: nothing is left to do.
    bool step();
    /// Asks all that runs to save itself and end, and waits for it: 20 s at most, then it is killed.
    void stop();
    [[nodiscard]] BatchSnapshot snapshot(bool with_logs) const;
    [[nodiscard]] const std::vector<std::unique_ptr<QueuedJob>>& jobs() const { return jobs_; }

    [[nodiscard]] int cores() const { return cores_; }
    [[nodiscard]] std::uint64_t memory_bytes() const { return memory_bytes_; }

private:
    struct Free {
        int jobs, cores;
        std::uint64_t memory_bytes;
    };
    [[nodiscard]] Free what_is_free() const;
    void start_what_fits();
    void estimate_one_that_waits();
    [[nodiscard]] double mean_seconds() const;
    [[nodiscard]] int could_start(const Free& free) const;

    BatchContext& context_;
    int cores_;
    std::uint64_t memory_bytes_;
    std::vector<std::unique_ptr<QueuedJob>> jobs_;
    bool stopped_ = false;
    std::size_t replaced_ = 0;
};

}  // namespace voxtone::farm
