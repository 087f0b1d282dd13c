// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/base/cancel_on_signal.h"

#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "voxtone/base/contracts.h"

using namespace voxtone;

namespace {

/// Runs `child` in a process of its own; gives back its exit code, or minus the signal that ended it.
template <class Child>
int status_of(Child child) {
    const pid_t pid = fork();
    if (pid == 0) {
        for (const int number : {SIGINT, SIGTERM}) std::signal(number, SIG_DFL);  // not the test program's own handlers
        child();
        _exit(99);
    }
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

TEST_CASE("The first signal asks the work to stop") {
    for (const int number : {SIGINT, SIGTERM})
        CHECK(status_of([number] {
                  Progress progress;
                  const CancelOnSignal cancel(progress);
                  if (progress.cancelled()) _exit(1);
                  std::raise(number);
                  _exit(progress.cancelled() ? 5 : 2);
              }) == 5);
}

TEST_CASE("The second signal ends the program, whichever of the two it is") {
    CHECK(status_of([] {
              Progress progress;
              const CancelOnSignal cancel(progress);
              std::raise(SIGINT);
              std::raise(SIGINT);
          }) == -SIGINT);
    CHECK(status_of([] {
              Progress progress;
              const CancelOnSignal cancel(progress);
              std::raise(SIGTERM);
              std::raise(SIGINT);
          }) == -SIGINT);
}

TEST_CASE("Signals are as before when the work is over, and ignored ones stay ignored") {
    CHECK(status_of([] {
              {
                  Progress progress;
                  const CancelOnSignal cancel(progress);
              }
              std::raise(SIGINT);
          }) == -SIGINT);
    CHECK(status_of([] {
              std::signal(SIGINT, SIG_IGN);
              Progress progress;
              const CancelOnSignal cancel(progress);
              std::raise(SIGINT);
              _exit(progress.cancelled() ? 1 : 7);
          }) == 7);
}

TEST_CASE("Two at once are a mistake") {
    Progress progress;
    const CancelOnSignal first(progress);
    CHECK_THROWS_AS(CancelOnSignal(progress), ContractViolation);
}
