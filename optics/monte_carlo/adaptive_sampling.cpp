// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/adaptive_sampling.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/step_part.h"

namespace voxtone::optics {
namespace {

constexpr std::uint32_t paths_per_task = 4096;

/// Work for one thread: shares [first, last) of one channel.
struct Task {
    std::size_t channel, first, last;
};

/// The paths that are still wanted, in shares of tasks of about the same size.
std::vector<Task> make_tasks(std::size_t channels, std::vector<std::uint32_t>& drawn,
                             std::span<const std::uint32_t> wanted, std::vector<Share>& shares) {
    std::vector<Task> tasks;
    shares.clear();
    for (std::size_t c = 0; c < channels; ++c) {
        std::uint32_t room = 0;
        for (std::size_t v = c; v < drawn.size(); v += channels)
            while (drawn[v] < wanted[v]) {
                if (room == 0) {
                    tasks.push_back({c, shares.size(), shares.size()});
                    room = paths_per_task;
                }
                const std::uint32_t count = std::min(room, wanted[v] - drawn[v]);
                shares.push_back({static_cast<std::uint32_t>(v), drawn[v], count});
                tasks.back().last = shares.size();
                drawn[v] += count;
                room -= count;
            }
    }
    return tasks;
}

/// Nobody knows how many rounds there will be: each takes half of what is left.
class PartOfRounds {
public:
    PartOfRounds(const Progress* progress, bool has_more) : progress_(progress), has_more_(has_more) {}
    void begin_round(std::size_t tasks) {
        low_ = high_;
        high_ = has_more_ ? (1 + low_) / 2 : 1;
        tasks_ = tasks;
        done_ = 0;
    }
    void end_task() { tell_part(progress_, low_ + (high_ - low_) * double(++done_) / double(tasks_)); }

private:
    const Progress* progress_;
    bool has_more_;
    double low_ = 0, high_ = 0;
    std::size_t tasks_ = 0;
    std::atomic<std::size_t> done_{0};
};

}  // namespace

PathAddress path_address(const Surface& surface, std::size_t channels, const MonteCarloOptions& options,
                         const Share& share, std::uint32_t path) {
    return {surface.cells[share.value / channels].cell, static_cast<std::uint32_t>(share.value % channels),
            options.first_path + share.first + path};
}

Appearance draw_paths(std::size_t cells, std::size_t channels, const MonteCarloOptions& options,
                      const TraceShares& trace, MonteCarloSummary& summary, const Progress* progress) {
    const std::size_t values = cells * channels;
    VOXTONE_EXPECT(values <= ~std::uint32_t{0});
    std::vector<Tally> tallies(values);
    std::vector<std::uint32_t> drawn(values, 0), wanted(values, options.paths);
    std::vector<Share> shares;
    summary = {};
    summary.values = values;
    PartOfRounds parts(progress, options.error > 0);
    for (;;) {
        const std::vector<Task> tasks = make_tasks(channels, drawn, wanted, shares);
        if (tasks.empty()) break;
        parts.begin_round(tasks.size());
        parallel_for(
            0, tasks.size(), 1,
            [&](std::size_t t) {
                if (progress) progress->check_cancelled();
                trace(tasks[t].channel, std::span(shares).subspan(tasks[t].first, tasks[t].last - tasks[t].first),
                      tallies);
                parts.end_task();
            },
            progress);
        for (const Share& share : shares) summary.paths += share.count;
        if (options.error <= 0) break;
        for (std::size_t v = 0; v < values; ++v) {
            const double n = drawn[v], ratio = tallies[v].careful_error(n) / options.error;
            if (ratio <= 1 || drawn[v] >= options.max_paths) continue;
            // At least half as many again: the error that decides is itself uncertain.
            const double more = std::clamp(n * (ratio * ratio - 1) * 1.05, n / 2, 8 * n);
            wanted[v] =
                static_cast<std::uint32_t>(std::min(n + std::ceil(more), static_cast<double>(options.max_paths)));
        }
    }

    Appearance appearance;
    appearance.channels = channels;
    appearance.value.resize(values);
    appearance.standard_error.resize(values);
    for (std::size_t v = 0; v < values; ++v) {
        const double n = drawn[v], error = tallies[v].error(n);
        appearance.value[v] = static_cast<float>(tallies[v].mean(n));
        appearance.standard_error[v] = static_cast<float>(error);
        summary.largest_error = std::max(summary.largest_error, error);
        if (options.error > 0 && tallies[v].careful_error(n) > options.error) ++summary.error_too_large;
    }
    return appearance;
}

}  // namespace voxtone::optics
