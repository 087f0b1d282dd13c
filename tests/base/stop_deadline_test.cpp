// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/stop_deadline.h"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include <catch2/catch.hpp>

#include "base/process_usage.h"
#include "base/ticker.h"

using namespace voxtone;
using namespace std::chrono_literals;

namespace {

/// How a process ends that works so long, and is asked to stop or not.
int end_of(bool asked, std::chrono::milliseconds grace, std::chrono::milliseconds work) {
    const pid_t child = fork();
    if (child == 0) {
        Progress progress;
        {
            const StopDeadline deadline(progress, grace, [] { return 42; });
            if (asked) progress.cancel();
            std::this_thread::sleep_for(work);
        }
        _exit(7);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Memory that is there, whatever a compiler thinks of its use.
std::unique_ptr<volatile char[]> touched(std::size_t bytes) {
    std::unique_ptr<volatile char[]> memory(new volatile char[bytes]);
    constexpr std::size_t page = 4096;
    for (std::size_t i = 0; i < bytes; i += page) memory[i] = 1;
    return memory;
}

}  // namespace

TEST_CASE("Work that was asked to stop is left where it stands once its grace is over") {
    CHECK(end_of(true, 20ms, 60s) == 42);
    CHECK(end_of(true, 60s, 1ms) == 7);     // it ends by itself
    CHECK(end_of(false, 1ms, 200ms) == 7);  // nobody asked
}

TEST_CASE("What to know of a stop is kept until it is told") {
    CHECK(stop_advice().empty());
    set_stop_advice("go on with --resume");
    CHECK(stop_advice() == "go on with --resume");
    set_stop_advice("");
    CHECK(stop_advice().empty());
}

TEST_CASE("A ticker ticks until it is gone, and not before its time") {
    std::atomic<int> ticks{0};
    {
        const Ticker ticker(0.001, [&] { ++ticks; });
        while (ticks < 3) std::this_thread::yield();
    }
    const int last = ticks;
    std::this_thread::sleep_for(20ms);
    CHECK(ticks == last);
    {
        const Ticker slow(60, [&] { ticks = -1; });
    }
    CHECK(ticks == last);
}

TEST_CASE("What a process has used is told in bytes and seconds") {
    const std::uint64_t before = resident_bytes();
    CHECK(before > 1'000'000);
    CHECK(peak_memory_bytes() >= before / 2);  // the kernel counts the two by different means
    constexpr std::size_t block = 64'000'000;
    const auto held = touched(block);
    CHECK(resident_bytes() > before + block / 2);
    CHECK(peak_memory_bytes() > block);
    CHECK(peak_memory_bytes() < 100 * (before + block));
    // A child's, once it was waited for.
    const double cpu_before = cpu_seconds();
    const pid_t child = fork();
    if (child == 0) {
        const auto more = touched(3 * block);
        const auto until = std::chrono::steady_clock::now() + 100ms;
        while (std::chrono::steady_clock::now() < until || cpu_seconds() < 0.05) more[0] = 2;
        _exit(0);
    }
    waitpid(child, nullptr, 0);
    CHECK(peak_child_memory_bytes() > 3 * block);
    CHECK(cpu_seconds() > cpu_before + 0.04);
    CHECK(cpu_seconds() < cpu_before + 60);
}
