// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <sstream>
#include <string_view>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

/// Who holds a folder, as its lock file says: "HOST PID START SINCE SPACE". Of a file that cannot be understood,
/// nobody.
struct Holder {
    std::string host;
    pid_t pid = 0;
    std::uint64_t start = 0;  ///< of the process, in the kernel's ticks since the machine started
    std::string since;        ///< UTC
    std::string space;        ///< of its number (process_space)

    [[nodiscard]] bool is_of_this_space() const { return host == host_name() && space == process_space(); }
};

Holder this_process() {
    return {host_name(), getpid(), start_of_process(getpid()),
            fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))), process_space()};
}

Holder read_holder(int file) {
    std::array<char, 512> text{};
    const ssize_t size = pread(file, text.data(), text.size(), 0);
    std::istringstream fields(std::string(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0));
    Holder holder;
    if (!(fields >> holder.host >> holder.pid >> holder.start >> holder.since >> holder.space)) return {};
    return holder;
}

/// Without locks: whether what the file says is still so.
bool may_live(const Holder& holder) {
    if (holder.pid == 0) return false;
    return !holder.is_of_this_space() || start_of_process(holder.pid) == holder.start;
}

void write_holder(int file, const fs::path& path) {
    const Holder holder = this_process();
    const std::string text =
        fmt::format("{} {} {} {} {}\n", holder.host, holder.pid, holder.start, holder.since, holder.space);
    if (ftruncate(file, 0) != 0 || pwrite(file, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
        fail_to_write(path, "could not be written", errno);
}

/// Of who did not give the folder back: where locks are not carried between hosts it may hold it still.
std::string doubt_of(int file, const fs::path& lock) {
    constexpr std::time_t young_s = 60;
    const Holder before = read_holder(file);
    struct stat about {};
    if (before.pid == 0 || before.is_of_this_space() || fstat(file, &about) != 0) return {};
    if (std::time(nullptr) - about.st_mtime >= young_s) return {};
    return fmt::format(
        "{}: host {} (process {}) took this folder at {} and did not give it back; if it still works there, this file "
        "system carries no locks between hosts and both write into one folder: stop one of them",
        lock.parent_path().string(), before.host, before.pid, before.since);
}

[[noreturn]] void refuse(const fs::path& lock, const Holder& holder, bool locks_known) {
    const std::string who = holder.pid == 0 ? std::string("another job")
                                            : fmt::format("another job (host {}, process {}, since {})", holder.host,
                                                          holder.pid, holder.since);
    throw FolderHeld(fmt::format(
        "{}: is being written by {}; wait for it or name another folder{}", lock.parent_path().string(), who,
        locks_known ? std::string() : fmt::format(". If that job is no more, remove {}", lock.string())));
}

/// The file that was opened may have been removed by its holder since: it is no lock then.
bool is_still_named(int file, const fs::path& path) {
    struct stat opened {
    }, named{};
    return fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

}  // namespace

// Field 22 of /proc/PID/stat; the name before the third, the state, may hold anything but ends with the last
// parenthesis.
std::uint64_t start_of_process(pid_t pid) {
    std::ifstream file(fmt::format("/proc/{}/stat", pid));
    std::string text;
    std::getline(file, text);
    std::istringstream fields(text.substr(std::min(text.rfind(')') + 1, text.size())));
    std::string skipped;
    fields >> skipped;
    if (skipped == "Z" || skipped == "X") return 0;
    constexpr int fields_between = 18;  // from the state to the start time
    for (int i = 0; i < fields_between; ++i) fields >> skipped;
    std::uint64_t start = 0;
    fields >> start;
    return start;
}

std::string host_name() {
    std::array<char, 256> name{};
    if (gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "localhost";
    return name.data();
}

const std::string& process_space() {
    static const std::string space = [] {
        std::string known;
        std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), known);
        std::error_code none;
        known += fs::read_symlink("/proc/self/ns/pid", none).string();
        std::uint32_t hash = 2166136261;  // FNV-1a
        for (const char c : known) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619;
        return fmt::format("{:08x}", hash);
    }();
    return space;
}

FolderLock::FolderLock(const fs::path& folder, std::string_view name) : path_(folder / name) {
    for (;;) {
        OpenFile file(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
        if (!file) fail_to_write(folder, "cannot be written into", errno);
        const bool locked = flock(file.get(), LOCK_EX | LOCK_NB) == 0;
        const bool locks_known = locked || errno == EWOULDBLOCK || errno == EINTR;
        if (!locked && (locks_known || may_live(read_holder(file.get()))))
            refuse(path_, read_holder(file.get()), locks_known);
        if (!is_still_named(file.get(), path_)) continue;
        doubt_ = doubt_of(file.get(), path_);
        write_holder(file.get(), path_);
        file_ = std::move(file);
        return;
    }
}

FolderLock::~FolderLock() {
    std::error_code ignored;
    fs::remove(path_, ignored);  // before it is free: nobody may remove the next one's
}

}  // namespace voxtone::io
