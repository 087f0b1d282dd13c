// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "base/control_group.h"
#include "base/random.h"

using namespace voxtone;

TEST_CASE("Every index is visited once, for any grain and thread count") {
    for (std::size_t threads : {1, 2, 5})
        for (std::size_t grain : {0, 1, 7, 1000}) {
            const ThreadLimit limit(threads);
            std::vector<int> visits(777);
            parallel_for(0, visits.size(), grain, [&](std::size_t i) { ++visits[i]; });
            CHECK(visits == std::vector<int>(777, 1));
        }
}

TEST_CASE("Each task is done once, and behind all that it waits for") {
    constexpr std::uint32_t tasks = 400;
    for (const std::size_t threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        for (std::uint64_t round = 0; round < 5; ++round) {
            // Each waits for up to four of those before it.
            std::vector<std::vector<std::uint32_t>> followers(tasks), waits_for(tasks);
            for (std::uint32_t i = 1; i < tasks; ++i) {
                RandomStream random(round, i);
                for (std::uint32_t n = random.bits() % 5; n > 0; --n) {
                    const std::uint32_t before = random.bits() % i;
                    if (std::count(waits_for[i].begin(), waits_for[i].end(), before)) continue;
                    waits_for[i].push_back(before);
                    followers[before].push_back(i);
                }
            }
            std::vector<std::atomic<int>> done(tasks);
            std::atomic<int> early = 0;
            parallel_graph(std::span<const std::vector<std::uint32_t>>(followers), [&](std::uint32_t i) {
                for (const std::uint32_t before : waits_for[i]) early += done[before] == 0;
                ++done[i];
            });
            CHECK(early == 0);
            CHECK(std::count_if(done.begin(), done.end(), [](const auto& times) { return times == 1; }) == tasks);
        }
    }
}

TEST_CASE("Exceptions and cancellation reach the caller") {
    CHECK_THROWS_AS(parallel_for(0, 100, 1,
                                 [](std::size_t i) {
                                     if (i == 50) throw InputError("fifty");
                                 }),
                    InputError);
    Progress progress;
    std::atomic<int> visited = 0;
    CHECK_THROWS_AS(parallel_for(
                        0, 100000, 1,
                        [&](std::size_t) {
                            if (++visited == 10) progress.cancel();
                        },
                        &progress),
                    Cancelled);
    CHECK(visited < 100000);
}

TEST_CASE("A scheduler's job takes the cores that it was given") {
    CHECK(granted_cores(16) == 16);
    setenv("SLURM_CPUS_ON_NODE", "6", 1);
    CHECK(granted_cores(16) == 6);
    setenv("SLURM_CPUS_PER_TASK", "3", 1);
    CHECK(granted_cores(16) == 3);
    CHECK(granted_cores(2) == 2);  // bound to fewer
    setenv("SLURM_CPUS_PER_TASK", "1", 1);
    {
        const ThreadLimit every(0);
        CHECK(thread_count() == 1);
        const ThreadLimit asked(2);  // who says a number gets no more, within another limit
        CHECK(thread_count() == 1);
    }
    for (const char* no_number : {"0", "2(x3)", ""}) {
        setenv("SLURM_CPUS_PER_TASK", no_number, 1);
        CHECK(granted_cores(16) == 6);
    }
    unsetenv("SLURM_CPUS_PER_TASK");
    unsetenv("SLURM_CPUS_ON_NODE");
}
