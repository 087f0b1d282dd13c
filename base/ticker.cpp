// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/ticker.h"

#include <chrono>
#include <csignal>
#include <utility>

namespace voxtone {

namespace {

/// Signals are for the thread that works: it is the one whose calls they are to interrupt.
class SignalsBlocked {
public:
    SignalsBlocked() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;
    ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

private:
    sigset_t before_{};
};

}  // namespace

Ticker::Ticker(double period_s, std::function<void()> tick) {
    const SignalsBlocked inherited_by_the_thread;
    thread_ = std::thread([this, period_s, tick = std::move(tick)] {
        std::unique_lock lock(mutex_);
        while (!wake_.wait_for(lock, std::chrono::duration<double>(period_s), [this] { return over_; })) {
            lock.unlock();
            tick();
            lock.lock();
        }
    });
}

Ticker::~Ticker() {
    {
        const std::lock_guard lock(mutex_);
        over_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

}  // namespace voxtone
