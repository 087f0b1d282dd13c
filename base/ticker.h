// SPDX-License-Identifier: GPL-3.0-or-later
//
// Calls a function again and again from a thread of its own, so that a display moves while the work has nothing to say.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace voxtone {

class Ticker {
public:
    /// `tick` throws nothing.
    Ticker(double period_s, std::function<void()> tick);
    Ticker(const Ticker&) = delete;
    Ticker& operator=(const Ticker&) = delete;
    /// Returns when no call is under way any more.
    ~Ticker();

private:
    std::mutex mutex_;
    std::condition_variable wake_;
    bool over_ = false;
    std::thread thread_;
};

}  // namespace voxtone
