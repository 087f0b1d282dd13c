// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/cancel_on_signal.h"

#include <cerrno>
#include <chrono>
#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "base/contracts.h"
#include "base/stop_deadline.h"
#include "tests/outcomes.h"

using namespace voxtone;

namespace {

constexpr auto stop_signals = {SIGINT, SIGTERM, SIGUSR1, SIGHUP};

/// Runs `child` in a process of its own; gives back its exit code, or minus the signal that ended it.
template <class Child>
int status_of(Child child) {
    const pid_t pid = fork();
    if (pid == 0) {
        for (const int number : stop_signals) std::signal(number, SIG_DFL);  // not the test program's own handlers
        child();
        _exit(99);
    }
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

TEST_CASE("The first signal asks the work to stop, and says why") {
    for (const int number : stop_signals)
        CHECK(status_of([number] {
                  catch_stop_signals();
                  Progress progress;
                  const CancelOnSignal cancel(progress);
                  if (progress.cancelled()) _exit(1);
                  std::raise(number);
                  _exit(progress.cancelled() ? static_cast<int>(stop_code()) : 2);
              }) == (number == SIGINT ? 5 : 85));
}

TEST_CASE("How children ended is known to who was started with SIGCHLD ignored") {
    CHECK(status_of([] {
              std::signal(SIGCHLD, SIG_IGN);  // as a shell's `trap "" CHLD` leaves it, or a supervisor
              catch_stop_signals();
              const pid_t child = fork();
              if (child == 0) _exit(7);
              int status = 0;
              if (waitpid(child, &status, 0) != child) _exit(98);
              _exit(WEXITSTATUS(status));
          }) == 7);
}

TEST_CASE("A signal that comes before there is work stops it when it begins") {
    for (const int number : stop_signals)
        CHECK(status_of([number] {
                  catch_stop_signals();
                  std::raise(number);
                  Progress progress;
                  const CancelOnSignal cancel(progress);
                  _exit(progress.cancelled() ? static_cast<int>(stop_code()) : 2);
              }) == (number == SIGINT ? 5 : 85));
}

TEST_CASE("A reader of stdout that leaves ends nothing") {
    CHECK(status_of([] {
              int ends[2];
              if (pipe(ends) != 0) _exit(98);
              close(ends[0]);
              catch_stop_signals();
              _exit(write(ends[1], "x", 1) < 0 && errno == EPIPE ? 7 : 8);
          }) == 7);
}

TEST_CASE("A second Ctrl-C ends the program, a second SIGTERM or SIGUSR1 changes nothing") {
#ifdef __SANITIZE_THREAD__
    return test::skip("the thread sanitizer holds a signal back until the next call of the system");
#endif
    for (const int first : stop_signals)
        CHECK(status_of([first] {
                  catch_stop_signals();
                  Progress progress;
                  const CancelOnSignal cancel(progress);
                  std::raise(first);
                  std::raise(SIGINT);
              }) == -SIGINT);
    for (const int first : stop_signals)
        for (const int second : {SIGTERM, SIGUSR1})
            CHECK(status_of([first, second] {
                      catch_stop_signals();
                      Progress progress;
                      const CancelOnSignal cancel(progress);
                      std::raise(first);
                      std::raise(second);
                      _exit(static_cast<int>(stop_code()));
                  }) == (first == SIGINT ? 5 : 85));
}

TEST_CASE("Ignored signals stay ignored, and work that is over is not touched") {
    for (const int number : stop_signals)
        CHECK(status_of([number] {
                  std::signal(number, SIG_IGN);
                  catch_stop_signals();
                  Progress progress;
                  const CancelOnSignal cancel(progress);
                  std::raise(number);
                  _exit(progress.cancelled() ? 1 : 7);
              }) == 7);
    CHECK(status_of([] {
              catch_stop_signals();
              Progress progress;
              { const CancelOnSignal cancel(progress); }
              std::raise(SIGTERM);
              _exit(progress.cancelled() ? 1 : 7);
          }) == 7);
}

TEST_CASE("Work that does not look whether it was stopped is left where it stands") {
    CHECK(status_of([] {
              Progress progress;
              const StopDeadline deadline(progress, std::chrono::milliseconds(40), [] { return 85; });
              progress.cancel();
              for (;;) pause();
          }) == 85);
    // Work that ends by itself is not, and neither is what nobody asked to stop.
    for (const bool stop : {true, false})
        CHECK(status_of([stop] {
                  {
                      Progress progress;
                      const StopDeadline deadline(progress, std::chrono::hours(1), [] { return 85; });
                      if (stop) progress.cancel();
                  }
                  _exit(7);
              }) == 7);
}

TEST_CASE("Two at once are a mistake") {
    Progress progress;
    const CancelOnSignal first(progress);
    CHECK_THROWS_AS(CancelOnSignal(progress), ContractViolation);
}
