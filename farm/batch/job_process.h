// SPDX-License-Identifier: GPL-3.0-or-later
//
// A process that a batch has started: in a process group of its own, so that a Ctrl-C at the terminal is the batch's to
// handle, and asked to stop (SIGTERM) when the batch ends in any way, so that none is left behind.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace voxtone::farm {

/// How a process ended.
struct ProcessEnd {
    int exit_code = 0;  ///< -1 where a signal ended it
    int signal = 0;
    /// Most memory that it held, or one of those that it had started and waited for; 0: not known.
    std::uint64_t peak_bytes = 0;
};

struct ProcessStart {
    std::filesystem::path program;
    std::span<const std::string> arguments;       ///< behind the program's name
    std::filesystem::path input;                  ///< its stdin; empty: nothing
    std::filesystem::path log;                    ///< its stdout and stderr are appended here
    int kept_descriptor = -1;                     ///< a descriptor that it inherits; -1: none
    std::span<const std::string> variables = {};  ///< "NAME=value", added to our environment
};

class JobProcess {
public:
    /// To be called by the thread that the process shall not outlive. Throws TryAgain where no process can be made,
    /// FileError where a file cannot be opened. A program that cannot be run ends with 127 and says why in the log.
    explicit JobProcess(const ProcessStart& start);
    JobProcess(const JobProcess&) = delete;
    JobProcess& operator=(const JobProcess&) = delete;
    /// Kills what still runs.
    ~JobProcess();

    [[nodiscard]] pid_t pid() const { return pid_; }
    [[nodiscard]] std::uint64_t start_time() const { return start_time_; }
    /// Nothing while it runs.
    [[nodiscard]] std::optional<ProcessEnd> ended();
    /// To it and all that it started.
    void send(int signal) const;

private:
    pid_t pid_ = -1;
    std::uint64_t start_time_ = 0;
    std::optional<ProcessEnd> end_;
};

}  // namespace voxtone::farm
