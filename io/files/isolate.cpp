// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/isolate.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/files/isolate_protocol.h"

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
    const int up = fcntl(fd, F_DUPFD_CLOEXEC, isolation::lifeline_fd + 1);
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

bool write_request(int fd, const isolation::RequestHead& head, std::span<const std::byte> request) {
    return write_at(fd, 0, &head, sizeof head) && write_at(fd, sizeof head, request.data(), request.size());
}

// Between fork and exec only what is safe in a signal handler may be called: the child of a program with threads.

void limit(int resource, std::uint64_t value) {
    rlimit r{value, value};
    rlimit old{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &old) == 0 && old.rlim_max != RLIM_INFINITY)
        r.rlim_cur = r.rlim_max = std::min<rlim_t>(old.rlim_max, value);
    setrlimit(static_cast<__rlimit_resource>(resource), &r);
}

/// A stop is the parent's to handle, which kills the child; a crash is a crash.
void set_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, SIG_IGN);
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

[[noreturn]] void become(const char* program, int request, int result, int lifeline, const IsolationLimits& limits,
                         pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // it ended before it could be listened to
    set_signals();
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<std::uint64_t>(std::ceil(limits.timeout_s)) + 1);
    if (limits.memory_bytes) limit(RLIMIT_AS, isolation::loading_bytes + limits.memory_bytes);
    silence();
    dup2(request, isolation::request_fd);
    dup2(result, isolation::result_fd);
    dup2(lifeline, isolation::lifeline_fd);
#ifdef SYS_close_range
    syscall(SYS_close_range, isolation::lifeline_fd + 1, ~0u, 4u /* CLOSE_RANGE_CLOEXEC */);
#endif
    char* const arguments[] = {const_cast<char*>(program), nullptr};
    execv(program, arguments);
    const unsigned char head[isolation::head_bytes] = {static_cast<unsigned char>(Outcome::not_started),
                                                       static_cast<unsigned char>(errno)};
    [[maybe_unused]] const ssize_t written = write(isolation::result_fd, head, sizeof head);
    _exit(127);
}

std::string human(std::uint64_t bytes) {
    return bytes >= (1u << 30) ? fmt::format("{:.3g} GB", double(bytes) / (1 << 30))
                               : fmt::format("{:.3g} MB", double(bytes) / (1 << 20));
}

/// `size` bytes from `at` on.
std::vector<std::byte> fetch(int fd, std::size_t at, std::size_t size, const std::string& what) {
    std::vector<std::byte> bytes(size);
    for (std::size_t done = 0; done < size;) {
        const ssize_t got = pread(fd, bytes.data() + done, size - done, static_cast<off_t>(at + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw ResourceError(fmt::format("the parsed contents of {} cannot be fetched", what));
        done += static_cast<std::size_t>(got);
    }
    return bytes;
}

[[noreturn]] void throw_again(ExitCode code, const std::string& text) {
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

[[noreturn]] void tell_crash(const std::string& what, int status) {
    const std::string how = WIFSIGNALED(status)
                                ? fmt::format("signal {}, {}", WTERMSIG(status), strsignal(WTERMSIG(status)))
                                : fmt::format("exit code {}", WEXITSTATUS(status));
    throw InputError(fmt::format(
        "{} made its reader crash ({}), or run out of memory; the file is damaged, or hits a fault of the library "
        "that reads it: open it in a mesh editor and export it again",
        what, how));
}

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
      deadline_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                       std::chrono::duration<double>(limits.timeout_s))),
      result_(memory_file("result")) {
    const FileDescriptor asked(memory_file("request"));
    int ends[2] = {-1, -1};
    if (result_.get() < 0 || asked.get() < 0 || !write_request(asked.get(), {limits.memory_bytes}, request) ||
        pipe2(ends, O_CLOEXEC) != 0)
        throw ResourceError(
            fmt::format("{} cannot be read: no file descriptor is left ({})", what_, std::strerror(errno)));
    alive_.reset(ends[0]);
    const FileDescriptor lifeline(moved_up(ends[1]));
    const std::string path = program_.string();
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ < 0)
        throw ResourceError(
            fmt::format("{} cannot be read: no process can be started ({})", what_, std::strerror(errno)));
    if (pid_ == 0) become(path.c_str(), asked.get(), result_.get(), lifeline.get(), limits_, parent);
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

void IsolatedProgram::wait_for_end(const Progress* progress) const {
    for (;;) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - std::chrono::steady_clock::now()).count();
        pollfd waiting{alive_.get(), POLLIN, 0};
        const int ended = poll(&waiting, 1, static_cast<int>(std::clamp<long long>(left + 1, 0, 100)));
        if (progress) progress->check_cancelled();
        if (ended > 0) return;
        if (left <= 0)
            throw InputError(fmt::format(
                "reading {} took longer than {:g} s and was stopped; the file is damaged or made to hang readers: "
                "open it in a mesh editor and export it again",
                what_, limits_.timeout_s));
    }
}

std::vector<std::byte> IsolatedProgram::result(const Progress* progress) {
    wait_for_end(progress);
    const int status = reap();
    struct stat about {};
    fstat(result_.get(), &about);
    const auto size = static_cast<std::size_t>(about.st_size);
    if (size < isolation::head_bytes) tell_crash(what_, status);
    const std::vector<std::byte> head = fetch(result_.get(), 0, isolation::head_bytes, what_);
    const auto outcome = static_cast<Outcome>(head[0]);
    if (outcome == Outcome::not_started)
        throw FileError(fmt::format("{} cannot be read: {} cannot be run ({}); install voxtone again", what_,
                                    program_.string(), std::strerror(std::to_integer<int>(head[1]))));
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) tell_crash(what_, status);
    std::vector<std::byte> bytes = fetch(result_.get(), isolation::head_bytes, size - isolation::head_bytes, what_);
    const auto text = [&] { return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()); };
    switch (outcome) {
        case Outcome::result:
            return bytes;
        case Outcome::error:
            throw_again(static_cast<ExitCode>(head[1]), text());
        case Outcome::no_memory:
            throw InputError(fmt::format(
                "reading {} needs more than the {} of memory it may take; the file is damaged or too large: reduce its "
                "triangles or textures",
                what_, human(limits_.memory_bytes)));
        case Outcome::unknown:
            throw InputError(
                fmt::format("{} cannot be read ({}); open it in a mesh editor and export it again", what_, text()));
        default:
            tell_crash(what_, status);
    }
}

std::vector<std::byte> run_isolated(const std::string& what, const std::filesystem::path& program,
                                    std::span<const std::byte> request, const IsolationLimits& limits,
                                    const Progress* progress) {
    return IsolatedProgram(what, program, request, limits).result(progress);
}

}  // namespace voxtone::io
