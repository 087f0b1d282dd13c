// SPDX-License-Identifier: GPL-3.0-or-later
//
// Untrusted data in the hands of a program of its own, with a budget of memory and time, behind walls.
//
// Parsers (ours and other people's) may crash, hang or eat memory on a file made to do so, or be taken over by it. In
// another process that costs an error message and not the job; in another program the parsers' libraries cost nothing
// where no file is read. The program is given requests (bytes) and leaves results (bytes) in memory files; its end is
// io/files/serve_isolated.h, which raises the walls of io/files/sandbox.h before it looks at the first request. What
// comes back is believed in nothing: its size is looked at before memory is taken, its contents by who unpacks it.
//
// What its work throws as `Error` is thrown again here with its exit code. Everything else that can happen is told
// apart: a crash of its own is the file's fault (InputError), a limit that was given is reached (ResourceError), a
// condition of the machine stood in the way (TryAgain): killed from outside, less memory than was given, no answer in
// any time.
//
// The limits hold from its first instruction: they are set between fork and exec. That of memory is on address space
// (RLIMIT_AS): `memory_bytes` above what the program has mapped when its libraries are loaded, and at most
// `loading_bytes` more before. A sanitizer's shadow memory is larger than any budget, so it must be 0 (none) there.
// That of time is on time of the processor, so that a busy machine fails no file. The program inherits no open file,
// and ends when the thread that started it ends.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"

namespace voxtone::io {

struct IsolationLimits {
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< 0: no limit
    double timeout_s = 120;  ///< of the processor, for one request; > 0. Waiting ends after ten times that.
    std::vector<std::string> readable = {};  ///< files, and folders with all below them, that it may read; no other
    std::vector<std::string> listable = {};  ///< folders whose names it may list
    bool threads = false;                    ///< it may start threads, which stand behind the same walls
    std::string more = {};  ///< for messages: how the user allows more ("--read-memory"), if there is a way
};

/// Answers a question that an isolated program has while it works (ask_starter of io/files/serve_isolated.h). What it
/// throws as InputError is thrown there; what else it throws ends the program and comes out of `result`. It may add
/// MissingWall bits of a program that it starts.
using Answerer = std::function<std::vector<std::byte>(std::span<const std::byte> question, const Progress* progress,
                                                      std::uint8_t& missing_walls)>;

/// A program at work on requests, one at a time. It works on its own until an answer is asked for; its end is that of
/// this object.
class IsolatedProgram {
public:
    /// Starts it on a first request. `what` names the file in messages ("spot.obj"). Throws TryAgain when no process
    /// can be made, FileError when the program cannot be run.
    IsolatedProgram(std::string what, const std::filesystem::path& program, std::span<const std::byte> request,
                    const IsolationLimits& limits);
    IsolatedProgram(const IsolatedProgram&) = delete;
    IsolatedProgram& operator=(const IsolatedProgram&) = delete;
    ~IsolatedProgram();

    /// Waits for the answer to the request; to be asked once for each. Throws Error, InputError, FileError,
    /// ResourceError, TryAgain, Cancelled; after all but what its work threw the program is of no more use.
    [[nodiscard]] std::vector<std::byte> result(const Progress* progress = nullptr);
    /// The same, read piece by piece where it lies, each byte once: a picture may be most of the memory there is. Good
    /// until the next request, as long as this object lives.
    struct Pieces {
        std::uint64_t size = 0;
        std::function<void(void* to, std::size_t size)> fetch;
    };
    [[nodiscard]] Pieces result_in_pieces(const Progress* progress = nullptr);
    /// Who answers its questions; without one they are refused.
    void answer_by(Answerer answerer) { answerer_ = std::move(answerer); }
    /// The next request, when the last one was answered.
    void post_request(std::span<const std::byte> request);
    /// The same of another file, which `what` names in messages from here on.
    void post_request(std::span<const std::byte> request, std::string what);
    /// Seconds of the processor that the request at hand has taken, with those that were counted before.
    [[nodiscard]] double spent_s() const { return processor_s() - began_s_; }
    /// Counts `seconds` that others of its kind took towards the limit of the request at hand.
    void count_as_spent(double seconds) { began_s_ -= seconds; }

    /// MissingWall bits (io/files/sandbox.h), known with the first answer.
    [[nodiscard]] std::uint8_t missing_walls() const { return missing_walls_; }

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

    void send_request(std::span<const std::byte> request);
    void wake() const;
    [[nodiscard]] double processor_s() const;
    /// Whether it has answered; false: it has ended.
    [[nodiscard]] bool wait_for_answer(const Progress* progress) const;
    enum class Left : std::uint8_t { result, question };
    /// Whether a result or a question was left, and how many bytes it has behind the head. Throws what is an error.
    [[nodiscard]] std::pair<Left, std::uint64_t> look_at_answer();
    [[nodiscard]] std::vector<std::byte> whole_answer(std::uint64_t size) const;
    void reply_to(std::span<const std::byte> question, const Progress* progress);
    [[noreturn]] void tell_end();
    void refuse_file_limit() const;
    void refuse_descriptor_limit() const;
    [[noreturn]] void tell_no_memory(bool outside) const;
    int reap();

    std::string what_;
    std::filesystem::path program_;
    IsolationLimits limits_;
    FileDescriptor request_, result_;
    FileDescriptor line_{-1};
    pid_t pid_ = -1;
    double began_s_ = 0;  ///< time of the processor that was spent before this request
    std::uint8_t missing_walls_ = 0;
    Answerer answerer_;
};

/// The program's whole life: start, wait, result.
[[nodiscard]] std::vector<std::byte> run_isolated(const std::string& what, const std::filesystem::path& program,
                                                  std::span<const std::byte> request, const IsolationLimits& limits,
                                                  const Progress* progress = nullptr);

/// True in builds whose memory cannot be limited (address sanitizer).
[[nodiscard]] bool built_with_address_sanitizer();

}  // namespace voxtone::io
