// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/disk/folder_lock.h"
#include "io/disk/open_file.h"

namespace voxtone::farm {

namespace {

/// What the child needs, made before the fork: between fork and exec only what is safe in a signal handler is called.
struct Plan {
    const char* program;
    std::vector<char*> arguments, environment;
    int input, log, kept;
    pid_t parent;
};

void set_signals_to_default() {
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGPIPE, SIGXFSZ, SIGHUP}) std::signal(signal, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void become(const Plan& plan) {
    setpgid(0, 0);
    set_signals_to_default();
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != plan.parent) _exit(127);  // it ended before it could be listened to
    dup2(plan.input, STDIN_FILENO);
    dup2(plan.log, STDOUT_FILENO);
    dup2(plan.log, STDERR_FILENO);
    if (plan.kept >= 0) fcntl(plan.kept, F_SETFD, 0);
    execve(plan.program, plan.arguments.data(), plan.environment.data());
    constexpr std::string_view text = "voxtone: the program of the job cannot be run\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
    _exit(127);
}

/// Ours, and what is added to it, which wins.
std::vector<char*> environment_with(std::vector<std::string>& variables) {
    std::vector<char*> all;
    for (char** ours = environ; *ours != nullptr; ++ours) {
        const std::string_view variable(*ours);
        const std::string_view name = variable.substr(0, variable.find('=') + 1);
        if (std::ranges::none_of(variables, [&](const std::string& added) { return added.starts_with(name); }))
            all.push_back(*ours);
    }
    for (std::string& added : variables) all.push_back(added.data());
    all.push_back(nullptr);
    return all;
}

io::OpenFile opened(const std::filesystem::path& file, int flags) {
    io::OpenFile open_file(::open(file.c_str(), flags | O_CLOEXEC, 0666));
    if (!open_file) io::fail_to_write(file, "cannot be opened for a job", errno);
    return open_file;
}

}  // namespace

JobProcess::JobProcess(const ProcessStart& start) {
    const io::OpenFile input = opened(start.input.empty() ? "/dev/null" : start.input, O_RDONLY);
    const io::OpenFile log = opened(start.log, O_WRONLY | O_CREAT | O_APPEND);
    std::vector<std::string> command{start.program.filename().string()};
    command.insert(command.end(), start.arguments.begin(), start.arguments.end());
    std::vector<std::string> variables(start.variables.begin(), start.variables.end());
    Plan plan{start.program.c_str(), {},      environment_with(variables), input.get(), log.get(),
              start.kept_descriptor, getpid()};
    for (std::string& word : command) plan.arguments.push_back(word.data());
    plan.arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ < 0)
        throw TryAgain(
            fmt::format("a job cannot be started: the system makes no process ({}); try again", std::strerror(errno)));
    if (pid_ == 0) become(plan);
    setpgid(pid_, pid_);  // whoever of the two comes first
    start_time_ = io::start_of_process(pid_);
}

JobProcess::~JobProcess() {
    if (end_) return;
    send(SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
}

std::optional<ProcessEnd> JobProcess::ended() {
    if (end_) return end_;
    int status = 0;
    rusage usage{};
    const pid_t ended = wait4(pid_, &status, WNOHANG, &usage);
    if (ended < 0 && errno == ECHILD)
        throw TryAgain("how a job ended is not known: another part of this process waited for it; run the same again");
    if (ended != pid_) return std::nullopt;
    end_ = WIFSIGNALED(status) ? ProcessEnd{-1, WTERMSIG(status)} : ProcessEnd{WEXITSTATUS(status), 0};
    end_->peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    return end_;
}

void JobProcess::send(int signal) const {
    if (!end_) kill(-pid_, signal);
}

}  // namespace voxtone::farm
