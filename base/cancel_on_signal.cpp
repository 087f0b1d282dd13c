// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/cancel_on_signal.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <string_view>

#include <unistd.h>

#include "base/contracts.h"

namespace voxtone {

namespace {

constexpr std::array<int, 4> signals{SIGINT, SIGTERM, SIGUSR1, SIGHUP};
std::atomic<Progress*> target{nullptr};
std::atomic<int> first_signal{0};
// What a signal handler may touch.
static_assert(std::atomic<Progress*>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void set_handler(int number, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, nullptr);
}

/// Calls nothing but functions that are safe in a signal handler (POSIX.1-2017, 2.4.3).
void on_signal(int number) {
    const int saved_errno = errno;
    int none = 0;
    const bool first = first_signal.compare_exchange_strong(none, number);
    if (Progress* progress = target.load()) progress->cancel();
    set_handler(SIGINT, SIG_DFL);
    if (first && isatty(STDERR_FILENO)) {
        constexpr std::string_view text = "\nstopping; Ctrl-C again stops at once\n";
        [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
    }
    errno = saved_errno;
}

}  // namespace

void catch_stop_signals() {
    for (const int number : signals) {
        struct sigaction before {};
        sigaction(number, nullptr, &before);
        if (before.sa_handler != SIG_IGN) set_handler(number, on_signal);
    }
    for (const int number : {SIGPIPE, SIGXFSZ}) set_handler(number, SIG_IGN);
    set_handler(SIGCHLD, SIG_DFL);  // ignored, as some starters leave it, it takes away how a child ended
}

ExitCode stop_code() {
    const int number = first_signal;
    return number == 0 ? ExitCode::done : number == SIGINT ? ExitCode::unfinished : ExitCode::stopped;
}

CancelOnSignal::CancelOnSignal(Progress& progress) {
    Progress* nobody = nullptr;
    VOXTONE_EXPECT(target.compare_exchange_strong(nobody, &progress));
    if (first_signal != 0) progress.cancel();
}

CancelOnSignal::~CancelOnSignal() { target = nullptr; }

}  // namespace voxtone
