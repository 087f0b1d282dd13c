// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/io/files/taken_program.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <functional>
#include <map>

#include "tests/places.h"

namespace voxtone::test {

namespace {

/// Each gives a number below 0 where it was refused, with errno.
using Attempt = std::function<long(const char* path)>;

long open_as(const char* path, int flags) {
    const int fd = open(path, flags, 0600);
    if (fd >= 0) close(fd);
    return fd;
}

long connect_out(int family) {
    const int fd = socket(family, SOCK_STREAM, 0);
    if (fd < 0) return -1;
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(9);
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connect(fd, reinterpret_cast<const sockaddr*>(&there), sizeof there);
    close(fd);
    return 0;  // a socket alone is too much
}

long reap(pid_t child) {
    if (child == 0) _exit(0);
    if (child > 0) waitpid(child, nullptr, 0);
    return child;
}

long start_thread() {
    pthread_t thread{};
    const int error = pthread_create(
        &thread, nullptr, [](void*) -> void* { return nullptr; }, nullptr);
    if (error == 0) pthread_join(thread, nullptr);
    errno = error;
    return error == 0 ? 0 : -1;
}

/// By a thread that is started for it.
long read_in_thread(const char* path) {
    struct Read {
        const char* path;
        long result;
        int why;
    } read{path, -1, 0};
    pthread_t thread{};
    const auto work = [](void* given) -> void* {
        auto* const r = static_cast<Read*>(given);
        r->result = open_as(r->path, O_RDONLY);
        r->why = errno;
        return nullptr;
    };
    const int error = pthread_create(&thread, nullptr, work, &read);
    if (error == 0) pthread_join(thread, nullptr);
    errno = error == 0 ? read.why : error;
    return read.result;
}

long execute() {
    char name[] = "/bin/true";
    char* const arguments[] = {name, nullptr};
    return execv(name, arguments);  // comes back only when it is refused
}

long map_code() {
    void* const memory = mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory != MAP_FAILED) return 0;
    void* const data = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return mprotect(data, 4096, PROT_READ | PROT_EXEC);
}

long change_limits() {
    const rlimit limit{16, 16};
    return setrlimit(RLIMIT_NOFILE, &limit);
}

long list(const char* path) {
    DIR* const folder = opendir(path);
    if (!folder) return -1;
    const bool read = readdir(folder) != nullptr;
    closedir(folder);
    return read ? 0 : -1;
}

/// fcntl on a descriptor of its own.
long control(int command, int value) {
    const int fd = static_cast<int>(syscall(SYS_memfd_create, "own", 0));
    if (fd < 0) return fd;
    const long done = fcntl(fd, command, value);
    const int why = errno;
    close(fd);
    errno = why;
    return done;
}

long look_into_parent() {
    char byte = 0;
    const iovec here{&byte, 1}, there{reinterpret_cast<void*>(&look_into_parent), 1};
    return syscall(SYS_process_vm_readv, getppid(), &here, 1, &there, 1, 0);
}

const std::map<std::string, Attempt>& all_attempts() {
    static const std::map<std::string, Attempt> all = {
        {"read", [](const char* p) { return open_as(p, O_RDONLY); }},
        {"read in a thread", [](const char* p) { return read_in_thread(p); }},
        {"list", [](const char* p) { return list(p); }},
        {"write", [](const char* p) { return open_as(p, O_WRONLY); }},
        {"append", [](const char* p) { return open_as(p, O_RDWR | O_APPEND); }},
        {"create", [](const char* p) { return open_as((p + std::string(".new")).c_str(), O_RDONLY | O_CREAT); }},
        {"truncate", [](const char* p) { return open_as(p, O_RDONLY | O_TRUNC) >= 0 ? 0 : truncate(p, 0); }},
        {"remove", [](const char* p) { return unlink(p); }},
        {"rename", [](const char* p) { return rename(p, (p + std::string(".new")).c_str()); }},
        {"link",
         [](const char* p) {
             const std::string name = p + std::string(".new");
             return symlink("/etc/passwd", name.c_str()) == 0 ? 0 : link(p, name.c_str());
         }},
        {"folder", [](const char* p) { return mkdir((p + std::string(".new")).c_str(), 0700); }},
        {"mode", [](const char* p) { return chmod(p, 0777); }},
        {"owner", [](const char* p) { return chown(p, getuid(), getgid()); }},
        {"times", [](const char* p) { return utimensat(AT_FDCWD, p, nullptr, 0); }},
        {"attribute", [](const char* p) { return setxattr(p, "user.voxtone", "1", 1, 0); }},
        {"mount", [](const char* p) { return mount(p, p, nullptr, MS_BIND, nullptr); }},
        {"root", [](const char* p) { return chroot(p) == 0 ? 0 : chdir(p); }},
        {"node", [](const char* p) { return mkfifo((p + std::string(".new")).c_str(), 0600); }},
        {"connect", [](const char*) { return connect_out(AF_INET); }},
        {"listen", [](const char*) { return connect_out(AF_INET6); }},
        {"local socket", [](const char*) { return connect_out(AF_UNIX); }},
        {"exec", [](const char*) { return execute(); }},
        {"fork", [](const char*) { return reap(fork()); }},
        {"vfork", [](const char*) { return reap(static_cast<pid_t>(syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0))); }},
        {"thread", [](const char*) { return start_thread(); }},
        {"trace", [](const char*) { return ptrace(PTRACE_ATTACH, getppid(), nullptr, nullptr); }},
        {"kill", [](const char*) { return kill(getppid(), 0); }},
        {"signal by descriptor", [](const char*) { return control(F_SETSIG, SIGURG); }},
        {"owner of a descriptor", [](const char*) { return control(F_SETOWN, getpid()); }},
        {"signal at input", [](const char*) { return control(F_SETFL, O_ASYNC); }},
        {"flags of a descriptor", [](const char*) { return control(F_SETFL, O_NONBLOCK); }},
        {"code", [](const char*) { return map_code(); }},
        {"limits", [](const char*) { return change_limits(); }},
        {"priority", [](const char*) { return setpriority(PRIO_PROCESS, 0, 19); }},
        {"look in", [](const char*) { return look_into_parent(); }},
        {"namespace", [](const char*) { return unshare(CLONE_NEWUSER); }},
        {"keyring", [](const char*) { return syscall(SYS_keyctl, 0, -3, 1); }},
        {"io ring",
         [](const char*) {
             return syscall(SYS_io_uring_setup, 1, nullptr) < 0 && errno != EPERM && errno != ENOSYS ? 0 : -1;
         }},
        {"new call", [](const char*) { return syscall(500); }},
        {"events",
         [](const char*) {
             return syscall(SYS_perf_event_open, nullptr, 0, -1, -1, 0) < 0 && errno != EPERM ? 0 : -1;
         }},
        {"module", [](const char*) { return syscall(SYS_bpf, 0, nullptr, 0) < 0 && errno != EPERM ? 0 : -1; }},
        {"new filter", [](const char*) { return prctl(PR_SET_DUMPABLE, 1); }}};
    return all;
}

}  // namespace

std::string misbehaving_program() { return build_dir() + "/tests/io/misbehaving_program"; }

std::string attempt(const std::string& wish) {
    const std::size_t path = wish.find(" /");
    const auto found = all_attempts().find(wish.substr(0, path));
    if (found == all_attempts().end()) return {};
    const std::string file = path == std::string::npos ? std::string() : wish.substr(path + 1);
    errno = 0;
    return found->second(file.c_str()) >= 0 ? "done" : std::string("refused (") + std::strerror(errno) + ")";
}

}  // namespace voxtone::test
