// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a batch will be done: told from states, judged by batches that were simulated to their end.
#include "farm/batch/batch_outlook.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <catch2/catch.hpp>

using namespace voxtone::farm;
using Catch::Matchers::Contains;

namespace {

constexpr double begin_s = 1'795'000'000;

std::string utc(double seconds) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(std::llround(seconds))));
}

JobState queued(double expected_cpu_s = 0) {
    JobState state;
    state.expected_cpu_s = expected_cpu_s;
    return state;
}

JobState running(double since_s, int threads, double expected_cpu_s = 0) {
    JobState state = queued(expected_cpu_s);
    state.phase = JobPhase::running;
    state.threads = threads;
    state.runner = JobRunner{"another-host", 1, 1, utc(since_s)};
    return state;
}

JobState done(double end_s, double seconds, int threads, double expected_cpu_s = 0) {
    JobState state = queued(expected_cpu_s);
    state.phase = JobPhase::done;
    state.threads = threads;
    state.finished = utc(end_s);
    state.figures.emplace().seconds = seconds;
    return state;
}

/// A batch of jobs that take so long, on lanes that take the next job when they are free.
struct Simulated {
    std::vector<double> seconds, expected, from, to;
    double end_s = 0;

    void run(int lanes) {
        std::vector<double> free(std::size_t(lanes), begin_s);
        for (const double job : seconds) {
            const auto lane = std::min_element(free.begin(), free.end());
            from.push_back(*lane);
            *lane += job;
            to.push_back(*lane);
            end_s = std::max(end_s, *lane);
        }
    }
    [[nodiscard]] std::vector<JobState> at(double now_s) const {
        std::vector<JobState> states;
        for (std::size_t i = 0; i < seconds.size(); ++i) {
            if (to[i] <= now_s)
                states.push_back(done(to[i], seconds[i], 1, expected[i]));
            else if (from[i] <= now_s)
                states.push_back(running(from[i], 1, expected[i]));
            else
                states.push_back(queued(expected[i]));
        }
        return states;
    }
};

/// How many of two hundred batches end within the range that is told after this share of their time, and how far off
/// the middle is, as the mean logarithm.
struct Judged {
    int within = 0;
    double bias = 0, width = 0;
};

Judged judge(bool with_estimates, double told_at, double spread) {
    constexpr int batches = 200;
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    Judged judged;
    for (int b = 0; b < batches; ++b) {
        Simulated batch;
        const double slower = std::exp(0.4 * normal(random));  // this machine than that of the estimates
        for (int i = 0; i < 60; ++i) {
            const double size_s = 100 * std::exp(0.8 * normal(random));
            batch.expected.push_back(with_estimates ? size_s : 0);
            batch.seconds.push_back(size_s * slower * std::exp(spread * normal(random)));
        }
        batch.run(3);
        const double now_s = begin_s + told_at * (batch.end_s - begin_s);
        const auto outlook = batch_outlook(batch.at(now_s), now_s);
        REQUIRE(outlook);
        const double left_s = batch.end_s - now_s;
        judged.within += left_s >= outlook->least_s && left_s <= outlook->most_s;
        judged.bias += std::log(outlook->seconds / left_s) / batches;
        judged.width += std::log(outlook->most_s / outlook->least_s) / batches;
    }
    return judged;
}

}  // namespace

TEST_CASE("Equal jobs are done when arithmetic says so") {
    // Two at a time, 100 s each on two threads, ten of twenty done.
    std::vector<JobState> states;
    for (int i = 0; i < 10; ++i) states.push_back(done(begin_s + 100 * (1 + i / 2), 100, 2));
    for (int i = 0; i < 10; ++i) states.push_back(queued());
    states[10] = running(begin_s + 500, 2);
    states[11] = running(begin_s + 500, 2);
    const auto outlook = batch_outlook(states, begin_s + 500);
    REQUIRE(outlook);
    CHECK(outlook->left == 10);
    CHECK(outlook->measured == 10);
    CHECK(outlook->seconds == Approx(500).epsilon(0.25));  // of the spread some is not known of ten jobs
    CHECK(outlook->least_s < 500);
    CHECK(outlook->most_s > 500);
    CHECK_THAT(outlook_text(*outlook), Contains("the rest, 10 jobs, in "));
}

TEST_CASE("What is told at the beginning, in the midst and near the end holds the end, 19 times of 20") {
    for (const bool with_estimates : {true, false})
        for (const double told_at : {0.2, 0.5, 0.8}) {
            const Judged judged = judge(with_estimates, told_at, 0.3);
            INFO(with_estimates << " " << told_at << ": " << judged.within << " of 200, bias " << judged.bias
                                << ", width " << judged.width);
            CHECK(judged.within >= 180);
            CHECK(std::abs(judged.bias) < 0.15);
        }
}

TEST_CASE("Estimates make the range narrower, and those that are good make it narrow") {
    const Judged good = judge(true, 0.5, 0.1), fair = judge(true, 0.5, 0.5), none = judge(false, 0.5, 0.1);
    CHECK(good.width < fair.width);
    CHECK(good.width < none.width);
    CHECK(good.width < std::log(2.0));
}

TEST_CASE("Before any job is done, estimates alone are told with their own doubt, and without any nothing is") {
    const std::vector<JobState> known{running(begin_s, 2, 200), queued(200), queued(200)};
    const auto outlook = batch_outlook(known, begin_s);
    REQUIRE(outlook);
    CHECK(outlook->seconds == Approx(300).epsilon(0.1));
    CHECK(outlook->most_s / outlook->seconds > 1.5);
    CHECK_FALSE(batch_outlook(std::vector<JobState>{running(begin_s, 2), queued()}, begin_s));
    CHECK_FALSE(batch_outlook(std::vector<JobState>{running(begin_s, 2, 200), queued()}, begin_s));
}

TEST_CASE("Nothing is told of a batch that is done or that nobody works on, what failed is not waited for") {
    CHECK_FALSE(batch_outlook({}, begin_s));
    CHECK_FALSE(batch_outlook(std::vector<JobState>{done(begin_s, 10, 1)}, begin_s));
    CHECK_FALSE(batch_outlook(std::vector<JobState>{done(begin_s, 10, 1), queued()}, begin_s + 3600));
    JobState failed = queued();
    failed.phase = JobPhase::failed;
    const auto outlook = batch_outlook(std::vector<JobState>{done(begin_s, 10, 1), failed, queued()}, begin_s + 1);
    REQUIRE(outlook);
    CHECK(outlook->left == 1);
}

TEST_CASE("An earlier run of the batch says nothing of how fast this one is") {
    const double now_s = begin_s + 86400;
    const std::vector<JobState> today{done(now_s - 50, 100, 1), running(now_s - 50, 1), queued()};
    std::vector<JobState> states = today;  // and yesterday, on four lanes and faster
    for (int i = 0; i < 8; ++i) states.push_back(done(begin_s + 10 * (1 + i / 4), 10, 1));
    const auto outlook = batch_outlook(states, now_s), alone = batch_outlook(today, now_s);
    REQUIRE(outlook);
    REQUIRE(alone);
    CHECK(outlook->measured == 1);
    CHECK(outlook->seconds == alone->seconds);
    CHECK(outlook->least_s < 150);
    CHECK(outlook->most_s > 150);
}

TEST_CASE("A job that takes longer than it was thought to is not done yet") {
    const std::vector<JobState> states{done(begin_s, 100, 1), running(begin_s, 1)};
    const auto outlook = batch_outlook(states, begin_s + 1000);
    REQUIRE(outlook);
    CHECK(outlook->seconds > 0);
}
