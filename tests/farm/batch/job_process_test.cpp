// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_process.h"

#include <chrono>
#include <csignal>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;

namespace {

ProcessEnd end_of(const std::string& script) {
    const io::TemporaryFolder folder;
    const std::vector<std::string> arguments{"-c", script};
    JobProcess process({"/bin/sh", arguments, {}, folder.path() / "log", -1});
    for (;;) {
        if (const auto end = process.ended()) return *end;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace

TEST_CASE("How a process ended is told by its code or its signal") {
    CHECK(end_of("exit 3").exit_code == 3);
    CHECK(end_of("exit 3").signal == 0);
    const ProcessEnd killed = end_of("kill -9 $$");
    CHECK(killed.signal == SIGKILL);
    CHECK(killed.exit_code == -1);
}

TEST_CASE("The most memory that a process or what it started held is told") {
    constexpr std::uint64_t block = 200'000'000;
    CHECK(end_of("dd if=/dev/zero of=/dev/null bs=200000000 count=1 2>/dev/null; exit 0").peak_bytes > block);
    const std::uint64_t little = end_of("exit 0").peak_bytes;
    CHECK(little > 0);
    CHECK(little < block);
}
