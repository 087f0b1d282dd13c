// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/outcome.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include <poll.h>
#include <unistd.h>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/openjd_progress.h"
#include "base/printable.h"
#include "base/progress_events.h"

namespace voxtone::cli {

namespace {

/// What a message ends with: docs/messages/exit-codes.md has its remedy under this name.
const char* failure_name(ExitCode code) {
    switch (code) {
        case ExitCode::done:
            return "done";
        case ExitCode::bug:
            return "bug";
        case ExitCode::usage:
            return "usage";
        case ExitCode::invalid_input:
            return "invalid-input";
        case ExitCode::file:
            return "file";
        case ExitCode::unfinished:
            return "unfinished";
        case ExitCode::check_failed:
            return "check-failed";
        case ExitCode::try_again:
            return "try-again";
        case ExitCode::stopped:
            return "stopped";
    }
    return "bug";
}

int end_with(Messages messages, ExitCode code, const std::string& what) {
    const std::string message = fmt::format("{} [{}]", what, failure_name(code));
    std::fputs(printable("voxtone: " + message + "\n").c_str(), stderr);
    if (messages == Messages::events) print_out(error_event(code, message) + "\n");
    if (messages == Messages::openjd) print_out(openjd_failure(message) + "\n");
    return static_cast<int>(code);
}

/// The library's own, and TBB's, which tells it in words alone (a std::runtime_error of oneTBB 2021.8).
bool is_lack_of_threads(const std::exception& error) {
    const auto* const system = dynamic_cast<const std::system_error*>(&error);
    return (system && system->code() == std::errc::resource_unavailable_try_again) ||
           std::string_view(error.what()).starts_with("pthread_create has failed");
}

int end_with_current_exception(Messages messages) {
    try {
        throw;
    } catch (const Error& error) {
        return end_with(messages, error.exit_code(), error.what());
    } catch (const std::bad_alloc&) {
        return end_with(messages, ExitCode::unfinished,
                        "out of memory; use a smaller --size, fewer --threads or a machine with more memory");
    } catch (const ContractViolation& error) {
        return end_with(messages, ExitCode::bug, fmt::format("a bug of ours, please report it: {}", error.what()));
    } catch (const std::exception& error) {
        if (is_lack_of_threads(error))
            return end_with(messages, ExitCode::try_again,
                            "the machine has no room for another thread: memory or the number of processes is limited; "
                            "try fewer --threads, or again when less runs");
        return end_with(messages, ExitCode::bug,
                        fmt::format("an unexpected failure, please report it: {}", error.what()));
    } catch (...) {
        return end_with(messages, ExitCode::bug, "an unexpected failure of no known kind, please report it");
    }
}

/// The other end of the pipe that stdout is.
bool reader_has_left() {
    pollfd out{STDOUT_FILENO, POLLOUT, 0};
    return poll(&out, 1, 0) > 0 && (out.revents & POLLERR) != 0;
}

/// A result that its reader did not get is no success: the disk that stdout goes to may be full.
int noticing_lost_output(int code) {
    const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
    if (!lost) return code;
    const int why = errno;
    const bool left = reader_has_left();
    if (!left || isatty(STDERR_FILENO) == 0)  // who types `| head` knows
        std::fputs(
            fmt::format("voxtone: stdout could not be written ({}), so what was printed there is not whole; files "
                        "that were named are. Make room or choose another place for it [{}]\n",
                        std::strerror(left ? EPIPE : why), failure_name(ExitCode::try_again))
                .c_str(),
            stderr);
    return code == 0 ? static_cast<int>(ExitCode::try_again) : code;
}

}  // namespace

void print_out(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stdout); }

int guarded(Messages messages, const std::function<int()>& work) {
    int code;
    try {
        code = work();
    } catch (...) {
        code = end_with_current_exception(messages);
    }
    return noticing_lost_output(code);
}

}  // namespace voxtone::cli
