// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/memory_room.h"

#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>

#include <catch2/catch.hpp>

using namespace voxtone::slicer;
using namespace std::chrono_literals;

namespace {

/// A thread that stays in a room until it is let go.
class Guest {
public:
    Guest(MemoryRoom& room, std::uint64_t bytes)
        : done_(std::async(std::launch::async, [this, &room, bytes] {
              room.with([bytes] { return bytes; },
                        [this] {
                            in_.set_value();
                            leaves_.get_future().wait();
                        });
          })) {}
    ~Guest() { leave(); }
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    [[nodiscard]] bool is_in(std::chrono::milliseconds within) {
        return entered_.wait_for(within) == std::future_status::ready;
    }
    void leave() {
        if (left_) return;
        left_ = true;
        leaves_.set_value();
    }

private:
    std::promise<void> in_, leaves_;
    std::future<void> entered_ = in_.get_future();
    bool left_ = false;
    std::future<void> done_;  // the last: it waits for the thread
};

constexpr auto long_enough = 30s;
constexpr auto a_while = 50ms;

}  // namespace

TEST_CASE("As many are let in as memory has room for, to the last byte, and the next when one has left") {
    MemoryRoom room(10);
    Guest first(room, 6);
    REQUIRE(first.is_in(long_enough));
    Guest beside(room, 4);
    REQUIRE(beside.is_in(long_enough));
    Guest waits(room, 5);
    CHECK_FALSE(waits.is_in(a_while));
    beside.leave();
    CHECK_FALSE(waits.is_in(a_while));
    first.leave();
    CHECK(waits.is_in(long_enough));
}

TEST_CASE("What is larger than the room is let in alone") {
    MemoryRoom room(10);
    Guest large(room, 25);
    REQUIRE(large.is_in(long_enough));
    Guest small(room, 1);
    CHECK_FALSE(small.is_in(a_while));
    large.leave();
    REQUIRE(small.is_in(long_enough));
    Guest larger(room, 10);
    CHECK_FALSE(larger.is_in(a_while));
    small.leave();
    CHECK(larger.is_in(long_enough));
}

TEST_CASE("Who leaves by an exception takes no room any more, and it is told on") {
    MemoryRoom room(10);
    CHECK_THROWS_AS(room.with([] { return 8u; }, [] { throw std::runtime_error("full"); }), std::runtime_error);
    Guest next(room, 10);
    CHECK(next.is_in(long_enough));
}

TEST_CASE("What is needed is asked again whenever one leaves") {
    MemoryRoom room(10);
    Guest first(room, 6);
    REQUIRE(first.is_in(long_enough));
    std::atomic<std::uint64_t> needed = 8;
    std::promise<void> entered;
    std::future<void> in = entered.get_future();
    const auto second =
        std::async(std::launch::async, [&] { room.with([&] { return needed.load(); }, [&] { entered.set_value(); }); });
    Guest third(room, 2);
    REQUIRE(third.is_in(long_enough));
    CHECK(in.wait_for(a_while) == std::future_status::timeout);
    needed = 4;
    third.leave();
    CHECK(in.wait_for(long_enough) == std::future_status::ready);
    first.leave();
}
