// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/stop_deadline.h"

#include <csignal>
#include <cstdlib>
#include <mutex>
#include <utility>

#include <pthread.h>

namespace voxtone {

namespace {

std::mutex advice_mutex;
std::string advice_text;

/// Signals are for the thread that works.
void block_all_signals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

StopDeadline::StopDeadline(const Progress& progress, std::chrono::milliseconds grace, std::function<int()> leave)
    : watch_([this, &progress, grace, leave = std::move(leave)] {
          constexpr std::chrono::milliseconds look(20);  // a signal handler can wake nobody
          block_all_signals();
          std::chrono::milliseconds left = grace;
          while (!over_) {
              std::this_thread::sleep_for(look);
              if (!progress.cancelled()) continue;
              left -= look;
              if (left <= std::chrono::milliseconds(0) && !over_.exchange(true)) std::_Exit(leave());
          }
      }) {}

StopDeadline::~StopDeadline() {
    over_ = true;
    watch_.join();
}

void set_stop_advice(const std::string& advice) {
    const std::scoped_lock lock(advice_mutex);
    advice_text = advice;
}

std::string stop_advice() {
    const std::scoped_lock lock(advice_mutex);
    return advice_text;
}

}  // namespace voxtone
