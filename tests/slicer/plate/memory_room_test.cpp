// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/memory_room.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include <catch2/catch.hpp>

using namespace voxtone::slicer;
using namespace std::chrono_literals;

namespace {

/// A thread that stays in a room until it is let go. It is not waited for: in a room that lets nobody in it never ends.
class Guest {
public:
    Guest(const std::shared_ptr<MemoryRoom>& room, std::uint64_t bytes) : Guest(room, [bytes] { return bytes; }) {}
    Guest(const std::shared_ptr<MemoryRoom>& room, std::function<std::uint64_t()> needed)
        : stay_(std::make_shared<Stay>()), entered_(stay_->in.get_future()) {
        std::thread([stay = stay_, room, needed = std::move(needed)] {
            room->with(needed, [&] {
                stay->in.set_value();
                stay->leaves.get_future().wait();
            });
        }).detach();
    }
    ~Guest() { leave(); }
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    [[nodiscard]] bool is_in(std::chrono::milliseconds within) {
        return entered_.wait_for(within) == std::future_status::ready;
    }
    void leave() {
        if (!std::exchange(left_, true)) stay_->leaves.set_value();
    }

private:
    struct Stay {
        std::promise<void> in, leaves;
    };
    std::shared_ptr<Stay> stay_;
    std::future<void> entered_;
    bool left_ = false;
};

/// Of ten bytes.
std::shared_ptr<MemoryRoom> room_of_ten() { return std::make_shared<MemoryRoom>(10); }

constexpr auto long_enough = 10s;
constexpr auto a_while = 50ms;

}  // namespace

TEST_CASE("As many are let in as memory has room for, to the last byte, and the next when one has left") {
    const auto room = room_of_ten();
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
    const auto room = room_of_ten();
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
    const auto room = room_of_ten();
    CHECK_THROWS_AS(room->with([] { return 8u; }, [] { throw std::runtime_error("full"); }), std::runtime_error);
    Guest next(room, 10);
    CHECK(next.is_in(long_enough));
}

TEST_CASE("What is needed is asked again whenever one leaves") {
    const auto room = room_of_ten();
    Guest first(room, 6);
    REQUIRE(first.is_in(long_enough));
    const auto needed = std::make_shared<std::atomic<std::uint64_t>>(8);
    Guest second(room, [needed] { return needed->load(); });
    Guest third(room, 2);
    REQUIRE(third.is_in(long_enough));
    CHECK_FALSE(second.is_in(a_while));
    *needed = 4;
    third.leave();
    CHECK(second.is_in(long_enough));
}
