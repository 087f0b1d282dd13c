// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/batch_outlook.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <vector>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/progress_bar.h"
#include "base/random.h"
#include "io/disk/folder_lock.h"

namespace voxtone::farm {

namespace {

constexpr double idle_s = 60;  ///< a longer pause ends a run

/// Of a job that was worked on: from when to when, and how much that was.
struct Worked {
    double from_s = 0, to_s = 0;
    double threads = 1;
    double expected_core_s = 0;  ///< 0: there is no estimate

    [[nodiscard]] double core_s() const { return (to_s - from_s) * threads; }
};

/// What was interrupted on this host waits.
bool is_running(const JobState& state) {
    return state.phase == JobPhase::running && state.runner &&
           (state.runner->host != io::host_name() || lives_here(*state.runner));
}

double cores_of(const JobState& state) { return std::max(1, state.threads); }

std::vector<Worked> done_jobs(std::span<const JobState> states) {
    std::vector<Worked> all;
    for (const JobState& state : states) {
        const auto end_s = seconds_of(state.finished);
        if (state.phase != JobPhase::done || !end_s || !state.figures || state.figures->seconds <= 0) continue;
        const double seconds = state.figures->seconds;
        all.push_back({*end_s - seconds, *end_s, cores_of(state), state.expected_cpu_s});
    }
    return all;
}

std::vector<Worked> running_jobs(std::span<const JobState> states, double now_s) {
    std::vector<Worked> all;
    for (const JobState& state : states) {
        if (!is_running(state)) continue;
        const double since_s = std::min(seconds_of(state.runner->since).value_or(now_s), now_s);
        all.push_back({since_s, now_s, cores_of(state), state.expected_cpu_s});
    }
    return all;
}

/// Since when there was always something that was worked on; what was done before that is of another run.
double run_since_s(std::vector<Worked> worked, double now_s) {
    std::sort(worked.begin(), worked.end(), [](const Worked& a, const Worked& b) { return a.to_s > b.to_s; });
    double since_s = now_s;
    for (const Worked& job : worked) {
        if (job.to_s < since_s - idle_s) break;
        since_s = std::min(since_s, job.from_s);
    }
    return since_s;
}

/// Logarithms as they were seen, before that as `prior_sd` has it, which counts as three of them.
struct Logs {
    double mean = 0;
    double sd = 0;       ///< of one
    double mean_sd = 0;  ///< of the mean: how well that is known
    bool known = false;  ///< one was seen
};

Logs logs_of(const std::vector<double>& values, double prior_sd) {
    constexpr double weight = 3;
    Logs logs{0, prior_sd, prior_sd, !values.empty()};
    if (values.empty()) return logs;
    const auto count = double(values.size());
    for (const double value : values) logs.mean += value / count;
    double sum = weight * prior_sd * prior_sd;
    for (const double value : values) sum += (value - logs.mean) * (value - logs.mean);
    logs.sd = std::sqrt(sum / (weight + count - 1));
    logs.mean_sd = logs.sd / std::sqrt(count);
    return logs;
}

/// What this run has shown.
struct Seen {
    Logs factor;  ///< of work over its estimate
    Logs work;    ///< of jobs without one, in seconds of a core
    std::size_t done = 0, running = 0;
    double threads = 1;  ///< of a job, on the average
    double lanes = 1;    ///< jobs at once
};

Seen seen_in(std::span<const JobState> states, double now_s) {
    std::vector<Worked> done = done_jobs(states), worked = running_jobs(states, now_s);
    Seen seen;
    seen.running = worked.size();
    worked.insert(worked.end(), done.begin(), done.end());
    const double since_s = run_since_s(worked, now_s);
    const auto is_earlier = [&](const Worked& job) { return job.to_s < since_s; };
    std::erase_if(worked, is_earlier);
    std::erase_if(done, is_earlier);
    std::vector<double> factors, works;
    for (const Worked& job : done) {
        works.push_back(std::log(job.core_s()));
        if (job.expected_core_s > 0) factors.push_back(works.back() - std::log(job.expected_core_s));
    }
    seen.done = done.size();
    seen.factor = logs_of(factors, std::log(1.5));
    seen.work = logs_of(works, std::log(3.0));
    double threads = 0, seconds = 0;
    for (const Worked& job : worked) threads += job.threads, seconds += job.to_s - job.from_s;
    if (!worked.empty()) seen.threads = threads / double(worked.size());
    if (now_s > since_s) seen.lanes = std::round(seconds / (now_s - since_s));
    seen.lanes = std::max({seen.lanes, double(seen.running), 1.0});
    return seen;
}

/// A job that is left.
struct Left {
    double expected_core_s = 0;
    bool runs = false;
    double threads = 1, worked_s = 0;  ///< of one that runs
};

std::vector<Left> jobs_left(std::span<const JobState> states, double now_s) {
    std::vector<Left> left;
    for (const JobState& state : states) {
        if (state.phase != JobPhase::queued && state.phase != JobPhase::running) continue;
        Left job{state.expected_cpu_s, is_running(state), cores_of(state), 0};
        if (job.runs) job.worked_s = std::max(0.0, now_s - seconds_of(state.runner->since).value_or(now_s));
        left.push_back(job);
    }
    // Those that run are on their lanes already.
    std::stable_partition(left.begin(), left.end(), [](const Left& job) { return job.runs; });
    return left;
}

/// Ways in which the rest of the batch may go, each as likely as the others: a job takes the lane that is free first.
class Courses {
public:
    Courses(const Seen& seen, const std::vector<Left>& left) : seen_(seen), left_(left) {}

    [[nodiscard]] double seconds(std::uint64_t course) {
        RandomStream random(course, 0);
        const double factor = seen_.factor.mean + seen_.factor.mean_sd * normal(random);
        const double work = seen_.work.mean + seen_.work.mean_sd * normal(random);
        std::priority_queue<double, std::vector<double>, std::greater<>> lanes;
        for (int lane = 0; lane < int(seen_.lanes); ++lane) lanes.push(0);
        double end_s = 0;
        for (const Left& job : left_) {
            const bool estimated = job.expected_core_s > 0;
            const double mean = estimated ? std::log(job.expected_core_s) + factor : work;
            const double sd = estimated ? seen_.factor.sd : seen_.work.sd;
            const double job_end_s = lanes.top() + time_of(job, mean, sd, random);
            lanes.pop();
            lanes.push(job_end_s);
            end_s = std::max(end_s, job_end_s);
        }
        return end_s;
    }

private:
    /// Box and Muller's.
    static double normal(RandomStream& random) {
        const double u = 1 - random.uniform(), v = random.uniform();
        return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
    }
    /// From now on. Of one that runs it is known that it was not done until now.
    double time_of(const Left& job, double mean, double sd, RandomStream& random) const {
        if (!job.runs) return std::exp(mean + sd * normal(random)) / seen_.threads;
        constexpr int tries = 30;
        for (int i = 0; i < tries; ++i)
            if (const double all_s = std::exp(mean + sd * normal(random)) / job.threads; all_s > job.worked_s)
                return all_s - job.worked_s;
        return job.worked_s * (std::exp(sd * std::abs(normal(random))) - 1);  // none was thought to take so long
    }

    const Seen& seen_;
    const std::vector<Left>& left_;
};

}  // namespace

std::optional<BatchOutlook> batch_outlook(std::span<const JobState> states, double now_s) {
    const std::vector<Left> left = jobs_left(states, now_s);
    const Seen seen = seen_in(states, now_s);
    if (left.empty() || seen.done + seen.running == 0) return std::nullopt;
    const bool all_known = std::all_of(left.begin(), left.end(),
                                       [&](const Left& job) { return job.expected_core_s > 0 || seen.work.known; });
    if (!all_known) return std::nullopt;
    constexpr std::size_t courses = 400, tail = courses / 40;
    std::vector<double> seconds;
    Courses possible(seen, left);
    for (std::size_t course = 0; course < courses; ++course) seconds.push_back(possible.seconds(course));
    std::sort(seconds.begin(), seconds.end());
    return BatchOutlook{left.size(), seen.done, seconds[courses / 2], seconds[tail], seconds[courses - 1 - tail]};
}

std::string outlook_text(const BatchOutlook& outlook) {
    return fmt::format("the rest, {}, in {} to {}", counted(outlook.left, "job"), duration_text(outlook.least_s),
                       duration_text(outlook.most_s));
}

}  // namespace voxtone::farm
