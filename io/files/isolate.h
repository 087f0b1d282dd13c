// SPDX-License-Identifier: GPL-3.0-or-later
//
// Untrusted data in the hands of a program of its own, with a budget of memory and time.
//
// Parsers (ours and other people's) may crash, hang or eat memory on a file made to do so. In another process that
// costs an error message and not the job; in another program the parsers' libraries cost nothing where no file is read.
// The program is given a request (bytes) in one memory file and leaves its result (bytes) in another; its end is
// io/files/serve_isolated.h. What its work throws as `Error` is thrown again here with its exit code; everything else
// that can happen to it (a signal, no memory, no time) becomes an InputError that says so.
//
// The limits hold from its first instruction: they are set between fork and exec. That of memory is on address space
// (RLIMIT_AS): `memory_bytes` above what the program has mapped when its libraries are loaded, and at most
// `loading_bytes` more before. A sanitizer's shadow memory is larger than any budget, so it must be 0 (none) there. The
// program inherits no open file, and ends when the thread that started it ends.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <chrono>

#include "voxtone/base/progress.h"

namespace voxtone::io {

struct IsolationLimits {
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< 0: no limit
    double timeout_s = 120;                               ///< wall clock, from the start; > 0
};

/// A program at work on a request. It works on its own until its result is asked for; without that it is killed.
class IsolatedProgram {
public:
    /// Starts it. `what` names the file in messages ("spot.obj"). Throws ResourceError when no process can be made,
    /// FileError when the program cannot be run.
    IsolatedProgram(std::string what, const std::filesystem::path& program, std::span<const std::byte> request,
                    const IsolationLimits& limits);
    IsolatedProgram(const IsolatedProgram&) = delete;
    IsolatedProgram& operator=(const IsolatedProgram&) = delete;
    ~IsolatedProgram();

    /// Waits for what it leaves; to be asked once. Throws Error, InputError, FileError, ResourceError, Cancelled.
    [[nodiscard]] std::vector<std::byte> result(const Progress* progress = nullptr);

private:
    class FileDescriptor {
    public:
        explicit FileDescriptor(int fd) : fd_(fd) {}
        FileDescriptor(const FileDescriptor&) = delete;
        FileDescriptor& operator=(const FileDescriptor&) = delete;
        ~FileDescriptor() { reset(); }
        void reset(int fd = -1);
        [[nodiscard]] int get() const { return fd_; }

    private:
        int fd_;
    };

    void wait_for_end(const Progress* progress) const;
    int reap();

    std::string what_;
    std::filesystem::path program_;
    IsolationLimits limits_;
    std::chrono::steady_clock::time_point deadline_;
    FileDescriptor result_;
    FileDescriptor alive_{-1};  ///< the program holds the writing end as long as it lives
    pid_t pid_ = -1;
};

/// The program's whole life: start, wait, result.
[[nodiscard]] std::vector<std::byte> run_isolated(const std::string& what, const std::filesystem::path& program,
                                                  std::span<const std::byte> request, const IsolationLimits& limits,
                                                  const Progress* progress = nullptr);

/// True in builds whose memory cannot be limited (address sanitizer).
[[nodiscard]] bool built_with_address_sanitizer();

}  // namespace voxtone::io
