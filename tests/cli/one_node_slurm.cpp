// SPDX-License-Identifier: GPL-3.0-or-later
#include "one_node_slurm.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "tests/places.h"

namespace voxtone::test {

namespace fs = std::filesystem;

namespace {

/// Daemons lie where users' PATH does not lead.
std::string path_of(const std::string& program) {
    for (const char* folder : {"/usr/sbin", "/usr/local/sbin", "/sbin", "/usr/bin", "/usr/local/bin"})
        if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return (fs::path(folder) / program).string();
    return {};
}

std::string user_name() {
    const passwd* const entry = getpwuid(getuid());
    return entry ? entry->pw_name : std::to_string(getuid());
}

std::string short_host_name() {
    std::array<char, 256> name{};
    gethostname(name.data(), name.size() - 1);
    const std::string host = name.data();
    return host.substr(0, host.find('.'));
}

/// Another process may take it before it is used; then the daemon says so and the test fails.
int free_port() {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const bool bound = bind(socket, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                       getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    close(socket);
    if (!bound) throw std::runtime_error("no port is free");
    return ntohs(address.sin_port);
}

/// That of python/tests/one_node_slurm.py, too.
std::string configuration(const fs::path& at) {
    std::string text = read_file(fs::path(source_dir()) / "tests/data/one-node-slurm.conf");
    const std::array<std::pair<const char*, std::string>, 5> words{{{"@HOST@", short_host_name()},
                                                                    {"@USER@", user_name()},
                                                                    {"@FOLDER@", at.string()},
                                                                    {"@CONTROLLER_PORT@", std::to_string(free_port())},
                                                                    {"@NODE_PORT@", std::to_string(free_port())}}};
    for (const auto& [word, value] : words)
        for (std::size_t i = 0; (i = text.find(word, i)) != std::string::npos; i += value.size())
            text.replace(i, std::string(word).size(), value);
    return text;
}

/// Parents of all processes.
std::map<pid_t, pid_t> parents() {
    std::map<pid_t, pid_t> parent_of;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator("/proc", none)) {
        const std::string name = entry.path().filename().string();
        if (name.find_first_not_of("0123456789") != std::string::npos) continue;
        const std::string stat = read_file(entry.path() / "stat");
        const std::size_t end = stat.rfind(')');  // PID (NAME) STATE PARENT
        if (end == std::string::npos || end + 4 >= stat.size()) continue;
        parent_of[static_cast<pid_t>(std::stol(name))] = static_cast<pid_t>(std::atol(stat.c_str() + end + 4));
    }
    return parent_of;
}

/// All that this process has started, and they in turn, but for some and theirs.
std::vector<pid_t> descendants_without(const std::set<pid_t>& spared) {
    const std::map<pid_t, pid_t> parent_of = parents();
    std::vector<pid_t> found;
    for (const auto& [pid, parent] : parent_of) {
        pid_t above = pid;
        bool is_spared = false;
        while (above > 1 && above != getpid()) {
            is_spared = is_spared || spared.contains(above);
            const auto next = parent_of.find(above);
            above = next == parent_of.end() ? 0 : next->second;
        }
        if (pid != getpid() && above == getpid() && !is_spared) found.push_back(pid);
    }
    return found;
}

/// Killing gives orphans, whose new parent is this process: until none is left.
void kill_all_without(const std::set<pid_t>& spared) {
    for (int round = 0; round < 200; ++round) {
        bool any = false;
        for (const pid_t pid : descendants_without(spared)) {
            kill(pid, SIGKILL);
            any = waitpid(pid, nullptr, WNOHANG) != pid || any;
        }
        if (!any) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

}  // namespace

std::string OneNodeSlurm::what_is_missing() {
    for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "sinfo"})
        if (path_of(program).empty())
            return fmt::format("{} is not here (Debian: apt-get install slurm-wlm munge)", program);
    return {};
}

OneNodeSlurm::OneNodeSlurm() : folder_("slurm") {
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    std::random_device random;
    std::string key;
    for (int i = 0; i < 128; ++i) key += static_cast<char>(random());
    folder_.write("munge.key", key);
    chmod((folder_ / "munge.key").c_str(), 0400);
    for (const char* name : {"state", "spool"}) fs::create_directory(folder_.path() / name);
    folder_.write("slurm.conf", configuration(folder_.path()));
    setenv("SLURM_CONF", (folder_ / "slurm.conf").c_str(), 1);
    try {
        munge_ = start("munged",
                       {"--foreground", "--force", "--key-file=" + (folder_ / "munge.key"),
                        "--socket=" + (folder_ / "munge.socket"), "--pid-file=" + (folder_ / "munged.pid"),
                        "--log-file=" + (folder_ / "munged.log"), "--seed-file=" + (folder_ / "munged.seed")},
                       "munged.out");
        if (!wait_until([&] { return fs::exists(folder_.path() / "munge.socket"); }))
            throw std::runtime_error("munged does not come up: " + logs());
        controller_ = start("slurmctld", {"-D", "-f", folder_ / "slurm.conf"}, "controller.out");
        start_node();
    } catch (...) {
        stop_all();
        throw;
    }
}

OneNodeSlurm::~OneNodeSlurm() { stop_all(); }

void OneNodeSlurm::stop_all() {
    kill_all_without({});
    unsetenv("SLURM_CONF");
    prctl(PR_SET_CHILD_SUBREAPER, 0);
}

pid_t OneNodeSlurm::start(const std::string& program, const std::vector<std::string>& words, const char* log) {
    const std::string path = path_of(program), said = folder_ / log;
    std::vector<char*> arguments{const_cast<char*>(path.c_str())};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t parent = getpid(), child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child > 0) return child;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    const int out = open(said.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execv(path.c_str(), arguments.data());
    _exit(127);
}

void OneNodeSlurm::start_node() {
    node_ = start("slurmd", {"-D", "-f", folder_ / "slurm.conf"}, "node.out");
    if (!wait_until([] {
            const std::string state = ask("sinfo --noheader --format=%T 2>/dev/null");
            return state.starts_with("idle") || state.starts_with("mixed") || state.starts_with("allocated");
        }))
        throw std::runtime_error("the node does not come up: " + logs());
}

void OneNodeSlurm::crash_node() {
    kill_all_without({munge_, controller_});
    if (!wait_until([] { return ask("sinfo --noheader --format=%T 2>/dev/null").starts_with("down"); }))
        throw std::runtime_error("the node is not missed: " + logs());
}

std::string OneNodeSlurm::ask(const std::string& command) {
    FILE* const pipe = popen(command.c_str(), "r");
    if (!pipe) throw std::runtime_error("popen failed");
    std::string said;
    std::array<char, 1024> bytes{};
    for (std::size_t count; (count = std::fread(bytes.data(), 1, bytes.size(), pipe)) > 0;)
        said.append(bytes.data(), count);
    pclose(pipe);
    return said;
}

bool OneNodeSlurm::wait_until(const std::function<bool()>& so) {
    constexpr std::chrono::milliseconds between(50);
    constexpr std::chrono::seconds patience(240);
    const auto begin = std::chrono::steady_clock::now();
    while (!so()) {
        if (std::chrono::steady_clock::now() - begin > patience) return false;
        std::this_thread::sleep_for(between);
    }
    return true;
}

bool OneNodeSlurm::queue_empties() {
    return wait_until([] { return ask("squeue --noheader 2>&1").empty(); });
}

std::string OneNodeSlurm::logs() const {
    std::string text;
    for (const char* name : {"munged.out", "munged.log", "controller.out", "controller.log", "node.out", "node.log"}) {
        const std::string log = read_file(folder_.path() / name);
        text += fmt::format("--- {}\n{}", name, log.substr(log.size() - std::min<std::size_t>(log.size(), 3000)));
    }
    return text;
}

}  // namespace voxtone::test
