// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/isolate.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>

#include <fmt/format.h>

#include "voxtone/base/error.h"

#if defined(__SANITIZE_ADDRESS__)
#define VOXTONE_ADDRESS_SANITIZER 1
#else
#define VOXTONE_ADDRESS_SANITIZER 0
#endif

namespace voxtone::io {

namespace {

/// First byte of what the child leaves.
enum class Outcome : unsigned char { nothing, result, error, no_memory, unknown };

class FileDescriptor {
public:
    explicit FileDescriptor(int fd) : fd_(fd) {}
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    ~FileDescriptor() { reset(); }
    void reset() {
        if (fd_ >= 0) close(fd_);
        fd_ = -1;
    }
    [[nodiscard]] int get() const { return fd_; }

private:
    int fd_;
};

std::uint64_t mapped_bytes() {
    std::uint64_t pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
        unsigned long long value = 0;
        if (std::fscanf(file, "%llu", &value) == 1) pages = value;
        std::fclose(file);
    }
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

bool write_all(int fd, const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = write(fd, at, std::min<std::size_t>(size, std::size_t{1} << 30));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        at += written;
        size -= static_cast<std::size_t>(written);
    }
    return true;
}

void leave(int fd, Outcome outcome, int code, const void* data, std::size_t size) {
    const unsigned char head[2] = {static_cast<unsigned char>(outcome), static_cast<unsigned char>(code)};
    write_all(fd, head, 2);
    if (!write_all(fd, data, size)) {  // the memory file itself ran out
        const unsigned char full[2] = {static_cast<unsigned char>(Outcome::no_memory), 0};
        if (ftruncate(fd, 0) == 0 && lseek(fd, 0, SEEK_SET) == 0) write_all(fd, full, 2);
    }
}

void limit(int resource, std::uint64_t value) {
    rlimit r{value, value};
    rlimit old{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &old) == 0 && old.rlim_max != RLIM_INFINITY) {
        r.rlim_max = std::min<rlim_t>(old.rlim_max, value);
        r.rlim_cur = r.rlim_max;
    }
    setrlimit(static_cast<__rlimit_resource>(resource), &r);
}

[[noreturn]] void run_child(int result, const IsolationLimits& limits,
                            const std::function<std::vector<std::byte>()>& work) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGPIPE})
        if (!built_with_address_sanitizer() || signal == SIGINT)
            std::signal(signal, signal == SIGINT ? SIG_IGN : SIG_DFL);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<std::uint64_t>(std::ceil(limits.timeout_s)) + 1);
    if (limits.memory_bytes) limit(RLIMIT_AS, mapped_bytes() + limits.memory_bytes);
    if (!built_with_address_sanitizer()) {  // libraries chat about broken files; a sanitizer's report must be seen
        const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
        if (null >= 0) {
            dup2(null, STDOUT_FILENO);
            dup2(null, STDERR_FILENO);
        }
    }
    try {
        const std::vector<std::byte> bytes = work();
        leave(result, Outcome::result, 0, bytes.data(), bytes.size());
    } catch (const Error& error) {
        leave(result, Outcome::error, static_cast<int>(error.exit_code()), error.what(), std::strlen(error.what()));
    } catch (const std::bad_alloc&) {
        leave(result, Outcome::no_memory, 0, nullptr, 0);
    } catch (const std::exception& error) {
        leave(result, Outcome::unknown, 0, error.what(), std::strlen(error.what()));
    } catch (...) {
        leave(result, Outcome::unknown, 0, nullptr, 0);
    }
    _exit(0);
}

/// Kills and reaps the child unless it was reaped.
class Child {
public:
    explicit Child(pid_t pid) : pid_(pid) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (pid_ <= 0) return;
        kill(pid_, SIGKILL);
        reap();
    }
    int reap() {
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        pid_ = -1;
        return status;
    }

private:
    pid_t pid_;
};

std::string human(std::uint64_t bytes) {
    return bytes >= (1u << 30) ? fmt::format("{:.3g} GB", double(bytes) / (1 << 30))
                               : fmt::format("{:.3g} MB", double(bytes) / (1 << 20));
}

}  // namespace

bool built_with_address_sanitizer() { return VOXTONE_ADDRESS_SANITIZER; }

std::vector<std::byte> run_isolated(const std::string& what, const IsolationLimits& limits,
                                    const std::function<std::vector<std::byte>()>& work, const Progress* progress) {
    const FileDescriptor result(memfd_create("result", MFD_CLOEXEC));
    int ends[2];  // the child holds the writing end as long as it lives
    if (result.get() < 0 || pipe2(ends, O_CLOEXEC) != 0)
        throw ResourceError(
            fmt::format("{} cannot be read: no file descriptor is left ({})", what, std::strerror(errno)));
    const FileDescriptor alive(ends[0]);
    FileDescriptor lifeline(ends[1]);
    std::fflush(nullptr);
    const pid_t pid = fork();
    if (pid < 0)
        throw ResourceError(
            fmt::format("{} cannot be read: no process can be started ({})", what, std::strerror(errno)));
    if (pid == 0) run_child(result.get(), limits, work);
    Child child(pid);
    lifeline.reset();

    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::chrono::duration<double>(limits.timeout_s);
    for (;;) {
        pollfd waiting{alive.get(), POLLIN, 0};
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (left <= 0)
            throw InputError(fmt::format(
                "reading {} took longer than {:g} s and was stopped; the file is damaged or made to hang readers: "
                "open it in a mesh editor and export it again",
                what, limits.timeout_s));
        if (poll(&waiting, 1, static_cast<int>(std::min<long long>(left + 1, 100))) > 0) break;
        if (progress) progress->check_cancelled();
    }
    const int status = child.reap();
    struct stat about {};
    fstat(result.get(), &about);
    const std::size_t size = static_cast<std::size_t>(about.st_size);
    std::vector<std::byte> bytes(size);
    for (std::size_t done = 0; done < size;) {
        const ssize_t got = pread(result.get(), bytes.data() + done, size - done, static_cast<off_t>(done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw ResourceError(fmt::format("the parsed contents of {} cannot be fetched", what));
        done += static_cast<std::size_t>(got);
    }
    const Outcome outcome =
        WIFEXITED(status) && WEXITSTATUS(status) == 0 && size >= 2 ? static_cast<Outcome>(bytes[0]) : Outcome::nothing;
    const auto text = [&] { return std::string(reinterpret_cast<const char*>(bytes.data()) + 2, size - 2); };
    switch (outcome) {
        case Outcome::result:
            bytes.erase(bytes.begin(), bytes.begin() + 2);
            return bytes;
        case Outcome::error: {
            switch (const auto code = static_cast<ExitCode>(bytes[1])) {
                case ExitCode::invalid_input:
                    throw InputError(text());
                case ExitCode::file:
                    throw FileError(text());
                case ExitCode::unfinished:
                    throw ResourceError(text());
                case ExitCode::usage:
                    throw UsageError(text());
                default:
                    throw Error(code, text());
            }
        }
        case Outcome::no_memory:
            throw InputError(fmt::format(
                "reading {} needs more than the {} of memory it may take; the file is damaged or too large: reduce its "
                "triangles or textures",
                what, human(limits.memory_bytes)));
        case Outcome::unknown:
            throw InputError(
                fmt::format("{} cannot be read ({}); open it in a mesh editor and export it again", what, text()));
        case Outcome::nothing:
            break;
    }
    const std::string how = WIFSIGNALED(status)
                                ? fmt::format("signal {}, {}", WTERMSIG(status), strsignal(WTERMSIG(status)))
                                : fmt::format("exit code {}", WEXITSTATUS(status));
    throw InputError(fmt::format(
        "{} made its reader crash ({}), or run out of memory; the file is damaged, or hits a fault of the library "
        "that reads it: open it in a mesh editor and export it again",
        what, how));
}

}  // namespace voxtone::io
