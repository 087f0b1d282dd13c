// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/base/cancel_on_signal.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <string_view>

#include <unistd.h>

#include "voxtone/base/contracts.h"

namespace voxtone {

namespace {

constexpr std::array<int, 2> signals{SIGINT, SIGTERM};
std::atomic<Progress*> target{nullptr};
static_assert(std::atomic<Progress*>::is_always_lock_free);  // what a signal handler may touch
std::array<struct sigaction, signals.size()> before{};

/// Calls nothing but functions that are safe in a signal handler (POSIX.1-2017, 2.4.3).
void on_signal(int) {
    const int saved_errno = errno;
    if (Progress* progress = target.load()) progress->cancel();
    for (const int number : signals) {
        struct sigaction usual {};
        usual.sa_handler = SIG_DFL;
        sigaction(number, &usual, nullptr);
    }
    if (isatty(STDERR_FILENO)) {
        constexpr std::string_view text = "\nstopping; Ctrl-C again stops at once\n";
        [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
    }
    errno = saved_errno;
}

}  // namespace

CancelOnSignal::CancelOnSignal(Progress& progress) {
    Progress* nobody = nullptr;
    VOXTONE_EXPECT(target.compare_exchange_strong(nobody, &progress));
    for (std::size_t i = 0; i < signals.size(); ++i) {
        sigaction(signals[i], nullptr, &before[i]);
        if (before[i].sa_handler == SIG_IGN) continue;
        struct sigaction action {};
        action.sa_handler = on_signal;
        action.sa_flags = SA_RESTART;
        sigemptyset(&action.sa_mask);
        sigaction(signals[i], &action, nullptr);
    }
}

CancelOnSignal::~CancelOnSignal() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before[i], nullptr);
    target = nullptr;
}

}  // namespace voxtone
