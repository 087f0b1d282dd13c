// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/isolate.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "io/files/isolate_protocol.h"
#include "io/files/packed_values.h"

#if defined(__SANITIZE_ADDRESS__)
#define VOXTONE_ADDRESS_SANITIZER 1
#else
#define VOXTONE_ADDRESS_SANITIZER 0
#endif

namespace voxtone::io {

namespace {

using isolation::Outcome;

/// Above the numbers that the program will know its files by, so that none is covered before it was moved.
int moved_up(int fd) {
    if (fd < 0) return fd;
    const int up = fcntl(fd, F_DUPFD_CLOEXEC, isolation::line_fd + 1);
    const int why = errno;
    close(fd);
    errno = why;
    return up;
}

int memory_file(const char* name) { return moved_up(memfd_create(name, MFD_CLOEXEC)); }

bool write_at(int fd, std::size_t at, const void* data, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
        const ssize_t written =
            pwrite(fd, static_cast<const char*>(data) + done, size - done, static_cast<off_t>(at + done));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        done += static_cast<std::size_t>(written);
    }
    return true;
}

/// Replaces what is in the file.
bool fill(int fd, std::span<const std::byte> bytes) {
    return ftruncate(fd, 0) == 0 && write_at(fd, 0, bytes.data(), bytes.size());
}

/// The longest answer: what the program could hold at all.
std::uint64_t most_result_bytes(const IsolationLimits& limits) {
    constexpr std::uint64_t unlimited = std::uint64_t{64} << 30;
    return limits.memory_bytes ? limits.memory_bytes : unlimited;
}

// Between fork and exec only what is safe in a signal handler may be called: the child of a program with threads.

void limit(int resource, std::uint64_t value) {
    rlimit r{value, value};
    rlimit old{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &old) == 0 && old.rlim_max != RLIM_INFINITY)
        r.rlim_cur = r.rlim_max = std::min<rlim_t>(old.rlim_max, value);
    setrlimit(static_cast<__rlimit_resource>(resource), &r);
}

/// A stop is the parent's to handle, which kills the child; a file that grows too long is an error of writing; a crash
/// is a crash.
void set_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGHUP, SIGXFSZ}) std::signal(signal, SIG_IGN);
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGPIPE}) std::signal(signal, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Libraries chat about broken files; a sanitizer's report must be seen.
void silence() {
    const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (null < 0) return;
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
    if (!built_with_address_sanitizer()) dup2(null, STDERR_FILENO);
}

[[noreturn]] void become(const char* program, int request, int result, int line, const IsolationLimits& limits,
                         pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // it ended before it could be listened to
    set_signals();
    limit(RLIMIT_CORE, 0);
    if (limits.memory_bytes) limit(RLIMIT_AS, isolation::loading_bytes + limits.memory_bytes);
    silence();
    dup2(request, isolation::request_fd);
    dup2(result, isolation::result_fd);
    dup2(line, isolation::line_fd);
#ifdef SYS_close_range
    syscall(SYS_close_range, isolation::line_fd + 1, ~0u, 4u /* CLOSE_RANGE_CLOEXEC */);
#endif
    char* const arguments[] = {const_cast<char*>(program), nullptr};
    execv(program, arguments);
    const unsigned char head[isolation::head_bytes] = {static_cast<unsigned char>(Outcome::not_started),
                                                       static_cast<unsigned char>(errno), 0};
    [[maybe_unused]] const ssize_t written = write(isolation::result_fd, head, sizeof head);
    _exit(127);
}

/// `size` bytes from `at` on.
void fetch_to(void* to, int fd, std::size_t at, std::size_t size, const std::string& what) {
    for (std::size_t done = 0; done < size;) {
        const ssize_t got = pread(fd, static_cast<std::byte*>(to) + done, size - done, static_cast<off_t>(at + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw InputError(fmt::format("what the reader of {} left was taken away again", what));
        done += static_cast<std::size_t>(got);
    }
}
std::vector<std::byte> fetch(int fd, std::size_t at, std::size_t size, const std::string& what) {
    std::vector<std::byte> bytes(size);
    fetch_to(bytes.data(), fd, at, size, what);
    return bytes;
}

[[noreturn]] void throw_again(ExitCode code, const std::string& text) {
    if (code == ExitCode::try_again) throw TryAgain(text);
    switch (code) {
        case ExitCode::invalid_input:
            throw InputError(text);
        case ExitCode::file:
            throw FileError(text);
        case ExitCode::unfinished:
            throw ResourceError(text);
        case ExitCode::usage:
            throw UsageError(text);
        default:
            throw Error(ExitCode::invalid_input, text);
    }
}

std::string allow_more(const IsolationLimits& limits) {
    return limits.more.empty() ? std::string() : fmt::format("allow more with {}, or ", limits.more);
}

constexpr const char* another_copy = "open it in a program that made it or a mesh editor and export it again";

}  // namespace

bool built_with_address_sanitizer() { return VOXTONE_ADDRESS_SANITIZER; }

void IsolatedProgram::FileDescriptor::reset(int fd) {
    if (fd_ >= 0) close(fd_);
    fd_ = fd;
}

IsolatedProgram::IsolatedProgram(std::string what, const std::filesystem::path& program,
                                 std::span<const std::byte> request, const IsolationLimits& limits)
    : what_(std::move(what)),
      program_(program),
      limits_(limits),
      request_(memory_file("request")),
      result_(memory_file("result")) {
    const isolation::Orders orders{limits.memory_bytes, most_result_bytes(limits),
                                   limits.readable,     limits.listable,
                                   limits.threads,      {request.begin(), request.end()}};
    int ends[2] = {-1, -1};
    if (request_.get() < 0 || result_.get() < 0 || !fill(request_.get(), packed(orders)) ||
        socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        const int why = errno;
        if (why == EFBIG) refuse_file_limit();
        if (why == EMFILE) refuse_descriptor_limit();
        throw TryAgain(fmt::format("{} cannot be read: the system gives no file descriptor or memory ({}); try again",
                                   what_, std::strerror(why)));
    }
    line_.reset(ends[0]);
    const FileDescriptor far_end(moved_up(ends[1]));
    const std::string path = program_.string();
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ < 0)
        throw TryAgain(fmt::format("{} cannot be read: the system starts no process ({}); try again", what_,
                                   std::strerror(errno)));
    if (pid_ == 0) become(path.c_str(), request_.get(), result_.get(), far_end.get(), limits_, parent);
    wake();
}

IsolatedProgram::~IsolatedProgram() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    reap();
}

int IsolatedProgram::reap() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
}

/// Says that a request is there. A program that has ended is found out about by who waits for its answer.
void IsolatedProgram::wake() const {
    const char byte = 1;
    while (send(line_.get(), &byte, 1, MSG_NOSIGNAL) < 0 && errno == EINTR) {
    }
}

void IsolatedProgram::post_request(std::span<const std::byte> request) {
    began_s_ = processor_s();
    send_request(request);
}

void IsolatedProgram::post_request(std::span<const std::byte> request, std::string what) {
    what_ = std::move(what);
    post_request(request);
}

void IsolatedProgram::send_request(std::span<const std::byte> request) {
    if (!fill(request_.get(), request))
        throw TryAgain(
            fmt::format("{} cannot be read: the system gives no memory ({}); try again", what_, std::strerror(errno)));
    wake();
}

double IsolatedProgram::processor_s() const {
    clockid_t clock{};
    timespec spent{};
    if (pid_ <= 0 || clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &spent) != 0) return began_s_;
    return double(spent.tv_sec) + 1e-9 * double(spent.tv_nsec);
}

bool IsolatedProgram::wait_for_answer(const Progress* progress) const {
    constexpr double patience = 10;  // a machine may have ten times as much to do as it has processors
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
        pollfd waiting{line_.get(), POLLIN, 0};
        const int ready = poll(&waiting, 1, 100);
        if (progress) progress->check_cancelled();
        char byte = 0;
        if (ready > 0) return recv(line_.get(), &byte, 1, 0) == 1;
        if (processor_s() - began_s_ > limits_.timeout_s)
            throw ResourceError(fmt::format(
                "reading {} takes more than the {:g} s of processor time that it may; it is very large, or made to "
                "hang readers: {}{}",
                what_, limits_.timeout_s, allow_more(limits_), another_copy));
        const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
        if (waited.count() > patience * limits_.timeout_s)
            throw TryAgain(fmt::format(
                "reading {} was given up after {:g} s, most of them spent waiting for the machine or its disk; nothing "
                "is known to be wrong with the file: try again when there is less to do",
                what_, waited.count()));
    }
}

/// What a reader has read lies in memory that the system counts as a file.
void IsolatedProgram::refuse_file_limit() const {
    rlimit files{};
    getrlimit(RLIMIT_FSIZE, &files);
    if (files.rlim_cur == RLIM_INFINITY || files.rlim_cur > limits_.memory_bytes) return;
    throw TryAgain(fmt::format(
        "reading {} makes more than the {} that a file of this process may have (`ulimit -f`); nothing is known to be "
        "wrong with the file: try again with a higher limit",
        what_, memory_text(files.rlim_cur)));
}

/// Its lines to us and the libraries that it opens.
void IsolatedProgram::refuse_descriptor_limit() const {
    constexpr rlim_t few = 16;
    rlimit descriptors{};
    getrlimit(RLIMIT_NOFILE, &descriptors);
    if (descriptors.rlim_cur > few) return;
    throw TryAgain(fmt::format(
        "reading {} needs more open files than the {} that this process may have (`ulimit -n`); nothing is known to be "
        "wrong with the file: try again with a higher limit",
        what_, descriptors.rlim_cur));
}

void IsolatedProgram::tell_no_memory(bool outside) const {
    if (outside)
        throw TryAgain(fmt::format(
            "reading {} needs more memory than the address space that this process is limited to (`ulimit -v`, or a "
            "scheduler's limit); nothing is known to be wrong with the file: try again with a higher limit",
            what_));
    refuse_file_limit();
    throw ResourceError(fmt::format(
        "reading {} needs more than the {} of memory that it may take; it is very large, or made to fill the memory: "
        "{}make it smaller",
        what_, memory_text(limits_.memory_bytes), allow_more(limits_)));
}

/// It has ended without an answer: why?
void IsolatedProgram::tell_end() {
    const int status = reap();
    struct stat about {};
    fstat(result_.get(), &about);
    if (about.st_size == static_cast<off_t>(isolation::head_bytes)) {
        const std::vector<std::byte> head = fetch(result_.get(), 0, isolation::head_bytes, what_);
        if (static_cast<Outcome>(head[0]) == Outcome::not_started) {
            const int why = std::to_integer<int>(head[1]);
            const std::string text =
                fmt::format("{} cannot be read: {} cannot be run ({})", what_, program_.string(), std::strerror(why));
            if (why == ENOMEM || why == EAGAIN) throw TryAgain(text + "; try again");
            throw FileError(text + "; install voxtone again");
        }
    }
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        throw TryAgain(fmt::format(
            "the program that reads {} was killed by the system or another program, most likely because the machine's "
            "memory was used up; nothing is known to be wrong with the file: try again with more memory free",
            what_));
    refuse_descriptor_limit();
    // The loader of programs cannot map the libraries: it says so where nobody listens and leaves with 127.
    rlimit space{};
    getrlimit(RLIMIT_AS, &space);
    if (space.rlim_cur < isolation::loading_bytes) tell_no_memory(true);
    const std::string how = WIFSIGNALED(status)
                                ? fmt::format("signal {}, {}", WTERMSIG(status), strsignal(WTERMSIG(status)))
                                : fmt::format("exit code {}", WEXITSTATUS(status));
    throw InputError(
        fmt::format("{} made its reader crash ({}); the file is damaged, or hits a fault of the library that reads "
                    "it: {}",
                    what_, how, another_copy));
}

std::vector<std::byte> IsolatedProgram::whole_answer(std::uint64_t size) const {
    return fetch(result_.get(), isolation::head_bytes, size, what_);
}

std::pair<IsolatedProgram::Left, std::uint64_t> IsolatedProgram::look_at_answer() {
    struct stat about {};
    fstat(result_.get(), &about);
    const auto size = static_cast<std::uint64_t>(about.st_size);
    if (size < isolation::head_bytes || size > isolation::head_bytes + most_result_bytes(limits_))
        throw InputError(
            fmt::format("what the reader of {} left ({} bytes) is no answer; {}", what_, size, another_copy));
    const std::vector<std::byte> head = fetch(result_.get(), 0, isolation::head_bytes, what_);
    missing_walls_ |= std::to_integer<std::uint8_t>(head[2]);
    const auto outcome = static_cast<Outcome>(head[0]);
    const std::uint64_t bytes = size - isolation::head_bytes;
    constexpr std::uint64_t longest_message = 1 << 16;
    if (outcome != Outcome::result && outcome != Outcome::question && size > longest_message)
        throw InputError(fmt::format("what the reader of {} left is no answer; {}", what_, another_copy));
    const auto text = [&] {
        const std::vector<std::byte> said = whole_answer(bytes);
        return std::string(reinterpret_cast<const char*>(said.data()), said.size());
    };
    switch (outcome) {
        case Outcome::result:
            return {Left::result, bytes};
        case Outcome::question:
            return {Left::question, bytes};
        case Outcome::error:
            throw_again(static_cast<ExitCode>(head[1]), text());
        case Outcome::no_memory:
            tell_no_memory(head[1] != std::byte{0});
        case Outcome::unknown:
            throw InputError(fmt::format("{} cannot be read ({}); {}", what_, text(), another_copy));
        default:
            throw InputError(fmt::format("what the reader of {} left is no answer; {}", what_, another_copy));
    }
}

std::vector<std::byte> IsolatedProgram::result(const Progress* progress) {
    return whole_answer(result_in_pieces(progress).size);
}

IsolatedProgram::Pieces IsolatedProgram::result_in_pieces(const Progress* progress) {
    for (;;) {
        if (!wait_for_answer(progress)) tell_end();
        const auto [left, bytes] = look_at_answer();
        if (left == Left::question) {
            reply_to(whole_answer(bytes), progress);
            continue;
        }
        return {bytes, [this, at = isolation::head_bytes](void* to, std::size_t size) mutable {
                    fetch_to(to, result_.get(), at, size, what_);
                    constexpr std::size_t much = std::size_t{1} << 20;  // memory that is held here now
                    if (size >= much)
                        fallocate(result_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(at),
                                  static_cast<off_t>(size));
                    at += size;
                }};
    }
}

void IsolatedProgram::reply_to(std::span<const std::byte> question, const Progress* progress) {
    isolation::Reply reply;
    try {
        if (!answerer_) throw InputError(fmt::format("the reader of {} asks for what it may not have", what_));
        reply.answer = answerer_(question, progress, missing_walls_);
    } catch (const InputError& error) {
        reply.refusal = error.what();
    }
    send_request(packed(reply));
}

std::vector<std::byte> run_isolated(const std::string& what, const std::filesystem::path& program,
                                    std::span<const std::byte> request, const IsolationLimits& limits,
                                    const Progress* progress) {
    return IsolatedProgram(what, program, request, limits).result(progress);
}

}  // namespace voxtone::io
