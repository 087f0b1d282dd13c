// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/command_output.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/open_file.h"

extern char** environ;

namespace voxtone::farm {

namespace {

struct Pipe {
    io::OpenFile read, write;
    Pipe() {
        std::array<int, 2> ends{};
        if (pipe2(ends.data(), O_CLOEXEC) != 0)
            throw TryAgain(fmt::format("the system makes no pipe ({}); try again", std::strerror(errno)));
        read = io::OpenFile(ends[0]);
        write = io::OpenFile(ends[1]);
    }
};

/// The child has our signals at their defaults, and none blocked.
struct Attributes {
    posix_spawnattr_t value{};
    Attributes() {
        posix_spawnattr_init(&value);
        sigset_t signals;
        sigemptyset(&signals);
        posix_spawnattr_setsigmask(&value, &signals);
        for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGPIPE, SIGXFSZ, SIGHUP}) sigaddset(&signals, signal);
        posix_spawnattr_setsigdefault(&value, &signals);
        posix_spawnattr_setflags(&value, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    ~Attributes() { posix_spawnattr_destroy(&value); }
};

struct Descriptors {
    posix_spawn_file_actions_t value{};
    Descriptors(int out, int err) {
        posix_spawn_file_actions_init(&value);
        posix_spawn_file_actions_addopen(&value, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_adddup2(&value, out, STDOUT_FILENO);
        posix_spawn_file_actions_adddup2(&value, err, STDERR_FILENO);
    }
    Descriptors(const Descriptors&) = delete;
    Descriptors& operator=(const Descriptors&) = delete;
    ~Descriptors() { posix_spawn_file_actions_destroy(&value); }
};

/// Reads both until both are closed.
void read_all(int out, int err, CommandOutput& said) {
    std::array<pollfd, 2> ends{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
    const std::array<std::string*, 2> texts{&said.out, &said.err};
    std::array<char, 4096> bytes{};
    while (ends[0].fd >= 0 || ends[1].fd >= 0) {
        if (poll(ends.data(), ends.size(), -1) < 0) {
            if (errno == EINTR) continue;
            return;
        }
        for (std::size_t i = 0; i < ends.size(); ++i) {
            if (ends[i].fd < 0 || ends[i].revents == 0) continue;
            const ssize_t count = ::read(ends[i].fd, bytes.data(), bytes.size());
            if (count > 0)
                texts[i]->append(bytes.data(), static_cast<std::size_t>(count));
            else if (count == 0 || errno != EINTR)
                ends[i].fd = -1;
        }
    }
}

[[noreturn]] void fail_to_start(std::span<const std::string> command, int fault) {
    if (fault == EAGAIN || fault == ENOMEM)
        throw TryAgain(fmt::format("{} cannot be started: the system makes no process ({}); try again", command[0],
                                   std::strerror(fault)));
    if (fault == E2BIG) {
        std::size_t bytes = 0, longest = 0;
        for (const std::string& word : command) {
            bytes += word.size() + 1;
            longest = std::max(longest, word.size());
        }
        throw ResourceError(
            fmt::format("{} cannot be started: its words are longer than this system takes for one program ({} bytes, "
                        "the longest word {}; {}); hand over fewer jobs at once, or with shorter options",
                        command[0], bytes, longest, std::strerror(fault)));
    }
    throw FileError(fmt::format("{} is here and cannot be run ({}); is PATH that of this machine?", command[0],
                                std::strerror(fault)));
}

}  // namespace

std::string CommandOutput::reason() const {
    std::string text = err.empty() ? out : err;
    for (char& c : text)
        if (c == '\n' || c == '\t') c = ' ';
    text.erase(text.find_last_not_of(' ') + 1);
    text.erase(0, text.find_first_not_of(' '));
    return text.empty() ? fmt::format("it said nothing, and ended with {}", exit_code) : text;
}

CommandOutput run_command(std::span<const std::string> command) {
    Pipe out, err;
    const Descriptors descriptors(out.write.get(), err.write.get());
    const Attributes attributes;
    std::vector<std::string> copies(command.begin(), command.end());
    std::vector<char*> arguments;
    for (std::string& word : copies) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t pid = -1;
    CommandOutput said;
    const int fault =
        posix_spawnp(&pid, arguments[0], &descriptors.value, &attributes.value, arguments.data(), environ);
    if (fault == ENOENT || fault == ENOTDIR)
        return {CommandOutput::no_such_program, {}, fmt::format("{}: {}", command[0], std::strerror(fault))};
    if (fault != 0) fail_to_start(command, fault);
    out.write = {};
    err.write = {};
    read_all(out.read.get(), err.read.get(), said);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR)
            throw TryAgain(fmt::format("how {} ended is not known ({}); try again", command[0], std::strerror(errno)));
    said.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return said;
}

}  // namespace voxtone::farm
