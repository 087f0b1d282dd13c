// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/sandbox.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <system_error>

namespace voxtone::io {

namespace {

constexpr std::uint64_t most_open_files = 64;

bool limited_outside = false;

std::uint64_t mapped_bytes() {
    std::uint64_t pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
        unsigned long long value = 0;
        if (std::fscanf(file, "%llu", &value) == 1) pages = value;
        std::fclose(file);
    }
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Never above what was set from outside. Whether that was lower.
template <class Resource>
bool limit_to(Resource resource, std::uint64_t value) {
    rlimit limit{};
    if (getrlimit(resource, &limit) != 0) return false;
    const bool outside = limit.rlim_max != RLIM_INFINITY && limit.rlim_max < value;
    limit.rlim_cur = limit.rlim_max = outside ? limit.rlim_max : static_cast<rlim_t>(value);
    setrlimit(resource, &limit);
    return outside;
}

void set_limits(const WallLimits& limits) {
    limit_to(RLIMIT_CORE, 0);
    if (!limits.threads) limit_to(RLIMIT_NPROC, 0);  // it counts threads
    limit_to(RLIMIT_NOFILE, most_open_files);
    limit_to(RLIMIT_FSIZE, limits.file_bytes);
    if (limits.memory_bytes) limited_outside = limit_to(RLIMIT_AS, mapped_bytes() + limits.memory_bytes);
}

/// Opening below `path` for `access`. A path that is not there needs no leave: the reader finds out by itself.
void allow(int rules, const std::string& path, std::uint64_t access) {
    const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
    if (place < 0) return;
    struct stat about {};
    landlock_path_beneath_attr rule{};
    rule.parent_fd = place;
    rule.allowed_access = access;
    if (fstat(place, &about) != 0 || !S_ISDIR(about.st_mode))
        rule.allowed_access &= ~std::uint64_t{LANDLOCK_ACCESS_FS_READ_DIR};  // of a file it would be refused
    syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    close(place);
}

std::size_t count_threads() {
    std::error_code error;
    const std::filesystem::directory_iterator threads("/proc/self/task", error);
    return error ? 1 : static_cast<std::size_t>(std::distance(begin(threads), end(threads)));
}

/// Waits for threads that were told to end.
bool is_alone() {
    for (int tries = 0; tries < 200; ++tries) {
        if (count_threads() == 1) return true;
        usleep(1000);
    }
    return false;
}

/// As linux/landlock.h has it since Linux 6.12; what an older kernel does not know is 0.
struct LandlockRules {
    std::uint64_t files, network, scopes;
};
constexpr std::uint64_t scope_of_signals = 2;
constexpr long first_with_scopes = 6;

bool filter_files(const WallDoors& doors) {
    LandlockRules handled{};
    handled.files = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;  // all that its first version knows
    if (syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= first_with_scopes)
        handled.scopes = scope_of_signals;
    const int rules = static_cast<int>(syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0));
    if (rules < 0) return false;
    for (const std::string& path : doors.readable)
        allow(rules, path, LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR);
    for (const std::string& path : doors.listable) allow(rules, path, LANDLOCK_ACCESS_FS_READ_DIR);
    const bool stands = syscall(SYS_landlock_restrict_self, rules, 0) == 0;
    close(rules);
    return stands;
}

/// What parsing, memory and answering need.
constexpr int allowed_calls[] = {
    SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(write), SCMP_SYS(writev), SCMP_SYS(pwrite64),
    SCMP_SYS(lseek), SCMP_SYS(_llseek), SCMP_SYS(close), SCMP_SYS(ftruncate), SCMP_SYS(memfd_create), SCMP_SYS(dup),
    SCMP_SYS(fstat), SCMP_SYS(fstat64), SCMP_SYS(stat), SCMP_SYS(stat64), SCMP_SYS(lstat), SCMP_SYS(lstat64),
    SCMP_SYS(newfstatat), SCMP_SYS(fstatat64), SCMP_SYS(statx), SCMP_SYS(statfs), SCMP_SYS(fstatfs), SCMP_SYS(access),
    SCMP_SYS(faccessat), SCMP_SYS(faccessat2), SCMP_SYS(readlink), SCMP_SYS(readlinkat), SCMP_SYS(getdents),
    SCMP_SYS(getdents64), SCMP_SYS(getcwd), SCMP_SYS(fadvise64),
    // memory
    SCMP_SYS(brk), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(futex), SCMP_SYS(membarrier),
    // signals of its own, its end
    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn), SCMP_SYS(sigaltstack),
    SCMP_SYS(restart_syscall), SCMP_SYS(exit), SCMP_SYS(exit_group),
    // what can be asked of the system, and waiting
    SCMP_SYS(getpid), SCMP_SYS(gettid), SCMP_SYS(getuid), SCMP_SYS(geteuid), SCMP_SYS(getgid), SCMP_SYS(getegid),
    SCMP_SYS(getrlimit), SCMP_SYS(ugetrlimit), SCMP_SYS(getrusage), SCMP_SYS(sysinfo), SCMP_SYS(uname),
    SCMP_SYS(sched_getaffinity), SCMP_SYS(sched_yield), SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres),
    SCMP_SYS(clock_nanosleep), SCMP_SYS(nanosleep), SCMP_SYS(gettimeofday), SCMP_SYS(time), SCMP_SYS(times),
    SCMP_SYS(getrandom), SCMP_SYS(poll), SCMP_SYS(ppoll), SCMP_SYS(pause)};

/// Calls that a processor's kernel never had have negative numbers.
bool is_of_this_machine(int call) { return call >= 0; }

/// Bits `mask` of an argument that must be `value`.
scmp_arg_cmp where(unsigned argument, scmp_datum_t mask, scmp_datum_t value) {
    return {argument, SCMP_CMP_MASKED_EQ, mask, value};
}

/// A call only where all conditions hold.
bool allow_where(scmp_filter_ctx filter, int call, std::initializer_list<scmp_arg_cmp> conditions) {
    return !is_of_this_machine(call) ||
           seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, static_cast<unsigned>(conditions.size()),
                                  conditions.begin()) == 0;
}

/// Copies of a descriptor, its flags and its locks; nothing that lets the kernel send a signal to another process when
/// there is something to read (F_SETOWN, F_SETSIG, O_ASYNC).
bool allow_descriptor_control(scmp_filter_ctx filter, int call) {
    constexpr scmp_datum_t all_bits = 0xffffffff;  // the command is an int
    for (const int command : {F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD, F_SETFD, F_GETFL, F_GETLK})
        if (!allow_where(filter, call, {where(1, all_bits, static_cast<scmp_datum_t>(command))})) return false;
    return allow_where(filter, call, {where(1, all_bits, F_SETFL), where(2, O_ASYNC, 0)});
}

/// Numbers of calls that the list was made without, the same on every machine since Linux 5.1. Libraries ask whether
/// there is such a call, and know what to do without it.
bool add_unknown_calls(scmp_filter_ctx filter) {
    constexpr int first = 424, last = 767;
    for (int call = first; call <= last; ++call)
        if (std::ranges::find(allowed_calls, call) == std::end(allowed_calls) &&
            seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), call, 0) != 0)
            return false;
    return true;
}

/// As the C library starts them; in another process, another name space or as a process of its own they are refused.
bool allow_threads(scmp_filter_ctx filter) {
    constexpr scmp_datum_t flags = CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SYSVSEM | CLONE_SIGHAND | CLONE_THREAD |
                                   CLONE_SETTLS | CLONE_PARENT_SETTID | CLONE_CHILD_CLEARTID;
    return allow_where(filter, SCMP_SYS(clone), {where(0, ~scmp_datum_t{0}, flags)}) &&
           allow_where(filter, SCMP_SYS(set_robust_list), {}) && allow_where(filter, SCMP_SYS(rseq), {});
}

bool add_rules(scmp_filter_ctx filter, bool threads) {
    for (const int call : allowed_calls)
        if (is_of_this_machine(call) && seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) != 0) return false;
    if (!add_unknown_calls(filter) || (threads && !allow_threads(filter))) return false;
    constexpr scmp_datum_t writing = O_ACCMODE | O_CREAT | O_TRUNC | O_APPEND | (O_TMPFILE & ~O_DIRECTORY),
                           all_bits = ~scmp_datum_t{0};
    const auto self = static_cast<scmp_datum_t>(getpid());
    return allow_where(filter, SCMP_SYS(open), {where(1, writing, O_RDONLY)}) &&
           allow_where(filter, SCMP_SYS(openat), {where(2, writing, O_RDONLY)}) &&
           allow_descriptor_control(filter, SCMP_SYS(fcntl)) && allow_descriptor_control(filter, SCMP_SYS(fcntl64)) &&
           // no new code: the libraries are loaded
           allow_where(filter, SCMP_SYS(mmap), {where(2, PROT_EXEC, 0)}) &&
           allow_where(filter, SCMP_SYS(mmap2), {where(2, PROT_EXEC, 0)}) &&
           allow_where(filter, SCMP_SYS(mprotect), {where(2, PROT_EXEC, 0)}) &&
           // abort() signals its own process; limits may be asked for, and not set
           allow_where(filter, SCMP_SYS(tgkill), {where(0, all_bits, self)}) &&
           allow_where(filter, SCMP_SYS(kill), {where(0, all_bits, self)}) &&
           allow_where(filter, SCMP_SYS(prlimit64), {where(2, all_bits, 0)});
}

bool filter_calls(bool threads) {
    const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    if (!filter) return false;
    constexpr std::uint32_t by_halves = 2;
    seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, by_halves);  // else a call is held against the list one by one
    const bool stands = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1) == 0 &&  // in all threads
                        add_rules(filter, threads) && seccomp_load(filter) == 0;
    seccomp_release(filter);
    return stands;
}

}  // namespace

std::uint8_t raise_walls(const WallDoors& doors, const WallLimits& limits) {
    prctl(PR_SET_DUMPABLE, 0);  // no other process of the same user looks in, and no core is left
    std::uint8_t missing = 0;
    // The filter of files is one thread's: another one would stay outside. And one that starts late, to end at once,
    // maps 64 MB for what it allocates, which would be taken from what the reader may have.
    const bool alone = is_alone();
    set_limits(limits);  // before the filters: what is mapped already is read from a file
    const bool for_good = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
    if (!for_good || !alone || !filter_files(doors)) missing |= no_file_filter;
    if (!for_good || !filter_calls(limits.threads)) missing |= no_call_filter;
    return missing;
}

bool memory_was_limited_outside() { return limited_outside; }

std::string missing_walls_note(std::uint8_t missing) {
    if (missing == 0) return {};
    const char* const what = missing == no_file_filter   ? "Landlock, which shuts other files off from it, is"
                             : missing == no_call_filter ? "seccomp, which shuts system calls off from it, is"
                                                         : "seccomp and Landlock, which shut system calls and other "
                                                           "files off from it, are";
    return std::string("The program that reads files is less guarded on this system: ") + what +
           " not available (an old kernel, or a container that forbids it). Read only files that you trust.";
}

ToldWalls& told_walls() {
    static ToldWalls of_this_run;
    return of_this_run;
}

}  // namespace voxtone::io
