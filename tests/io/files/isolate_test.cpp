// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/isolate.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <catch2/catch.hpp>

#include "voxtone/base/error.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

std::vector<std::byte> run(const std::function<std::vector<std::byte>()>& work, IsolationLimits limits = {}) {
    if (built_with_address_sanitizer()) limits.memory_bytes = 0;
    return run_isolated("test.obj", limits, work);
}

}  // namespace

TEST_CASE("work in a child process") {
    SECTION("its result comes back, small or large") {
        for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{50} << 20}) {
            const std::vector<std::byte> bytes = run([&] {
                std::vector<std::byte> made(size);
                for (std::size_t i = 0; i < size; ++i) made[i] = static_cast<std::byte>(i * 7);
                return made;
            });
            REQUIRE(bytes.size() == size);
            bool same = true;
            for (std::size_t i = 0; i < size; ++i) same &= bytes[i] == static_cast<std::byte>(i * 7);
            CHECK(same);
        }
    }
    SECTION("errors keep their text and kind") {
        CHECK_THROWS_WITH(run([]() -> std::vector<std::byte> { throw InputError("line 7 is wrong"); }),
                          "line 7 is wrong");
        CHECK_THROWS_AS(run([]() -> std::vector<std::byte> { throw FileError("gone"); }), FileError);
        CHECK_THROWS_AS(run([]() -> std::vector<std::byte> { throw ResourceError("full"); }), ResourceError);
        CHECK_THROWS_WITH(run([]() -> std::vector<std::byte> { throw std::runtime_error("a library says so"); }),
                          Contains("a library says so"));
    }
    SECTION("a crash, a silent end, endless work, endless memory") {
        CHECK_THROWS_WITH(run([]() -> std::vector<std::byte> {
                              std::raise(SIGKILL);
                              return {};
                          }),
                          Contains("test.obj") && Contains("crash"));
        CHECK_THROWS_WITH(run([]() -> std::vector<std::byte> { _exit(3); }), Contains("exit code 3"));
        const auto start = std::chrono::steady_clock::now();
        CHECK_THROWS_WITH(run(
                              []() -> std::vector<std::byte> {
                                  for (std::atomic<int> i = 0;; ++i) {
                                  }
                              },
                              {.timeout_s = 0.2}),
                          Contains("0.2 s"));
        CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
        if (!built_with_address_sanitizer()) {
            CHECK_THROWS_WITH(run([]() -> std::vector<std::byte> { std::abort(); }), Contains("signal 6"));
            CHECK_THROWS_WITH(run(
                                  []() -> std::vector<std::byte> {
                                      std::vector<std::vector<std::byte>> hoard;
                                      for (;;) hoard.emplace_back(std::size_t{8} << 20);
                                  },
                                  {.memory_bytes = std::uint64_t{64} << 20}),
                              Contains("64 MB"));
        }
    }
    SECTION("the user's wish to stop ends the child") {
        Progress progress;
        std::thread user([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(150));
            progress.cancel();
        });
        CHECK_THROWS_AS(run_isolated(
                            "test.obj", {.memory_bytes = 0},
                            []() -> std::vector<std::byte> {
                                for (;;) pause();
                            },
                            &progress),
                        Cancelled);
        user.join();
    }
}
