// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/batch_queue.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>
#include <thread>

#include "base/parallel.h"

namespace voxtone::farm {

namespace {

using Stage = QueuedJob::Stage;

constexpr std::chrono::milliseconds look_every(20);
constexpr std::uint64_t weighing_bytes = std::uint64_t{1} << 30;  // of `estimate`, whose body is no larger than its job

bool has_ended(const QueuedJob& job) { return job.stage() == Stage::done || job.stage() == Stage::failed; }

}  // namespace

BatchQueue::BatchQueue(BatchContext& context)
    : context_(context),
      cores_(context.options.cores > 0 ? context.options.cores : static_cast<int>(thread_count())),
      memory_bytes_(memory_to_share(context.options)) {}

void BatchQueue::add(PlannedJob job) {
    jobs_.push_back(std::make_unique<QueuedJob>(context_, std::move(job), jobs_.size() + 1));
}

bool BatchQueue::add_or_replace(const PlannedJob& job) {
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
        if (jobs_[i]->name() != job.name) continue;
        if (!has_ended(*jobs_[i])) return false;
        jobs_[i] = std::make_unique<QueuedJob>(context_, job, i + 1);
        ++replaced_;
        return true;
    }
    add(job);
    return true;
}

std::size_t BatchQueue::ended() const {
    return replaced_ +
           std::size_t(std::count_if(jobs_.begin(), jobs_.end(), [](const auto& job) { return has_ended(*job); }));
}

BatchQueue::Free BatchQueue::what_is_free() const {
    const int most = context_.options.jobs > 0 ? context_.options.jobs : std::numeric_limits<int>::max();
    Free free{most, cores_, memory_bytes_};
    for (const auto& job : jobs_) {
        if (job->stage() == Stage::weighing) {
            free.cores -= 1;
            free.memory_bytes -= std::min(free.memory_bytes, weighing_bytes);
        }
        if (job->stage() != Stage::running) continue;
        free.jobs -= 1;
        free.cores -= job->threads();
        free.memory_bytes -= std::min(free.memory_bytes, job->weight().memory_bytes);
    }
    return free;
}

/// How many of those that wait would fit beside each other.
int BatchQueue::could_start(const Free& free) const {
    int count = 0;
    std::uint64_t memory = free.memory_bytes;
    for (const auto& job : jobs_) {
        if (count == free.jobs || count == free.cores) break;
        if (!job->is_due() || job->weight().memory_bytes > memory) continue;
        memory -= job->weight().memory_bytes;
        ++count;
    }
    return count;
}

void BatchQueue::start_what_fits() {
    Free free = what_is_free();
    bool nothing_runs = free.cores == cores_;
    const bool in_order = context_.options.jobs == 1 || context_.options.fail_fast;
    for (const auto& job : jobs_) {
        if (free.jobs <= 0 || free.cores <= 0) return;
        // One after the other, or until the first that fails: in the order of the plan, not of estimates that come in.
        if (in_order && job->stage() == Stage::weighing) return;
        if (!job->is_due()) continue;
        const bool fits = job->weight().memory_bytes <= free.memory_bytes;
        if (!fits && job->weight().bound) {
            job->begin_to_weigh();
            free = what_is_free();
            nothing_runs = nothing_runs && job->stage() != Stage::weighing;
            if (in_order) return;
            continue;
        }
        // One that is too large for the machine runs alone: it says itself what it lacks.
        if (!fits && !nothing_runs) continue;
        if (!fits) job->warn_that_it_runs_alone(memory_bytes_);
        job->start(std::max(1, free.cores / std::max(1, could_start(free))));
        if (job->stage() == Stage::running) nothing_runs = false;
        free = what_is_free();
    }
}

/// Of the jobs that this batch has done; 0: of none.
double BatchQueue::mean_seconds() const {
    double sum = 0;
    int count = 0;
    for (const auto& job : jobs_) {
        if (job->stage() != Stage::done || job->was_unchanged() || !job->state().figures) continue;
        sum += job->state().figures->seconds;
        ++count;
    }
    return count > 0 ? sum / count : 0;
}

/// So that it can be told when the rest will be done (batch_outlook.h). An estimate takes half a second of a core,
/// which is little beside jobs that take so long; one is made at a time, whatever else runs.
void BatchQueue::estimate_one_that_waits() {
    const auto is_weighed = [](const auto& job) { return job->stage() == Stage::weighing; };
    if (std::any_of(jobs_.begin(), jobs_.end(), is_weighed) || mean_seconds() < context_.options.estimate_from_s)
        return;
    const auto next = std::find_if(jobs_.begin(), jobs_.end(), [](const auto& job) { return job->wants_estimate(); });
    if (next != jobs_.end()) (*next)->begin_to_weigh();
}

bool BatchQueue::step() {
    bool failed = false, left = false;
    for (const auto& job : jobs_) {
        job->poll();
        failed = failed || job->stage() == Stage::failed;
    }
    if (failed && context_.options.fail_fast) {
        stop();
        return false;
    }
    start_what_fits();
    estimate_one_that_waits();
    for (const auto& job : jobs_) left = left || !has_ended(*job);
    if (left) std::this_thread::sleep_for(look_every);
    return left;
}

void BatchQueue::stop() {
    if (stopped_) return;
    stopped_ = true;
    constexpr std::chrono::seconds patience(20);
    const auto began = std::chrono::steady_clock::now();
    for (const auto& job : jobs_) job->ask_to_stop(SIGTERM);
    for (bool killed = false;;) {
        bool runs = false;
        for (const auto& job : jobs_) {
            job->poll();
            runs = runs || job->stage() == Stage::running || job->stage() == Stage::following ||
                   job->stage() == Stage::weighing;
        }
        if (!runs) return;
        if (!killed && std::chrono::steady_clock::now() - began > patience) {
            for (const auto& job : jobs_) job->ask_to_stop(SIGKILL);
            killed = true;
        }
        std::this_thread::sleep_for(look_every);
    }
}

BatchSnapshot BatchQueue::snapshot(bool with_logs) const {
    BatchSnapshot all;
    all.jobs = jobs_.size();
    for (const auto& job : jobs_) {
        all.done += job->stage() == Stage::done || job->stage() == Stage::following;
        all.unchanged += job->was_unchanged();
        all.failed += job->stage() == Stage::failed;
        if (job->stage() == Stage::running)
            all.running.push_back(with_logs ? job->snapshot() : BatchSnapshot::Running{job->name(), 0, {}});
    }
    return all;
}

}  // namespace voxtone::farm
