// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <vector>

#include <catch2/catch.hpp>

#include "base/grant.h"

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
