// SPDX-License-Identifier: GPL-3.0-or-later
//
// The user's voice of errors. A message says what is wrong, where (file, key, line), why it matters and what to try.
// The kind decides the program's exit code (see `exit_code`); code that a caller can mend never throws anything else.
#pragma once

#include <stdexcept>
#include <string>

namespace voxtone {

/// Exit codes of the program, one per kind of outcome.
enum class ExitCode : int {
    done = 0,
    bug = 1,            ///< a contract of ours was broken
    usage = 2,          ///< the command line cannot be understood
    invalid_input = 3,  ///< the input or the job is invalid; trying again does not help
    file = 4,           ///< a file could not be read or written; trying again may help
    unfinished = 5,     ///< the pipeline could not finish: memory, cancelled
    check_failed = 6,   ///< a check (`verify`) found faults
    try_again = 75,     ///< nothing is wrong with the job: later or elsewhere it may go (EX_TEMPFAIL of sysexits.h)
    stopped = 85,       ///< on request, progress saved: run it again (HTCondor's checkpoint_exit_code)
};

/// Base of every error that is meant for the user.
class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    [[nodiscard]] ExitCode exit_code() const noexcept { return code_; }

private:
    ExitCode code_;
};

class UsageError : public Error {
public:
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

/// The input or the job is invalid, for good.
class InputError : public Error {
public:
    explicit InputError(const std::string& message) : Error(ExitCode::invalid_input, message) {}
};

/// A file could not be read or written.
class FileError : public Error {
public:
    explicit FileError(const std::string& message) : Error(ExitCode::file, message) {}
};

/// The work could not be finished for lack of a resource.
class ResourceError : public Error {
public:
    explicit ResourceError(const std::string& message) : Error(ExitCode::unfinished, message) {}
};

/// A condition of the machine stood in the way, not the job and not its files.
class TryAgain : public Error {
public:
    explicit TryAgain(const std::string& message) : Error(ExitCode::try_again, message) {}
};

/// The user asked to stop.
class Cancelled : public Error {
public:
    Cancelled() : Error(ExitCode::unfinished, "cancelled") {}
};

}  // namespace voxtone
