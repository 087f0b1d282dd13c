// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/part_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <ctime>
#include <optional>
#include <system_error>

#include <fmt/core.h>

#include "io/disk/folder_lock.h"
#include "io/disk/open_file.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view part_ending = ".part";

/// ".HOST.", as it stands in a temporary name.
std::string host_part() { return fmt::format(".{}.", host_name().substr(0, 64)); }

/// What temporary names of this file begin with, on this host.
std::string part_stem(const fs::path& file) {
    return fmt::format(".{}{}", file.filename().string().substr(0, 120), host_part());
}

/// Who writes a file, by the end of its temporary name.
struct PartMaker {
    std::string space;
    pid_t pid = 0;
    std::uint64_t start = 0;
};

std::string maker_text(const PartMaker& maker) { return fmt::format("{}-{}-{}", maker.space, maker.pid, maker.start); }

template <class Number>
bool read_number(const std::string& digits, Number& number) {
    const char* const end = digits.data() + digits.size();
    const auto [stopped, error] = std::from_chars(digits.data(), end, number);
    return error == std::errc() && stopped == end;
}

/// Nothing where the name is none of ours.
std::optional<PartMaker> maker_in(const std::string& name) {
    const std::string stem = name.substr(0, name.size() - part_ending.size());
    const std::string text = stem.substr(stem.rfind('.') + 1);
    const std::size_t pid = text.find('-'), start = text.find('-', pid + 1);
    if (pid == std::string::npos || start == std::string::npos) return std::nullopt;
    PartMaker maker{text.substr(0, pid)};
    const bool is_read = read_number(text.substr(pid + 1, start - pid - 1), maker.pid) &&
                         read_number(text.substr(start + 1), maker.start);
    return is_read && maker.pid > 0 ? std::optional(maker) : std::nullopt;
}

bool is_old(const fs::path& part) {
    constexpr std::time_t old_s = 3600;
    struct stat about {};
    return ::stat(part.c_str(), &about) == 0 && std::time(nullptr) - about.st_mtime > old_s;
}

/// Whether the process that a temporary name of this host tells of may live. Its file has no lock for a moment after it
/// was made, so the lock alone does not tell.
bool is_being_written(const fs::path& part) {
    const auto maker = maker_in(part.filename().string());
    if (!maker || maker->space != process_space()) return !is_old(part);
    return maker->pid != getpid() && start_of_process(maker->pid) == maker->start;
}

template <class Passes>
void sweep(const fs::path& folder, const Passes& passes) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (!is_part_name(name) || !passes(name) || is_being_written(entry.path())) continue;
        const OpenFile part(::open(entry.path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
        if (part && flock(part.get(), LOCK_EX | LOCK_NB) == 0) fs::remove(entry.path(), ignored);
    }
}

}  // namespace

std::string part_name(const fs::path& file) {
    const PartMaker maker{process_space(), getpid(), start_of_process(getpid())};
    return fmt::format("{}{}{}", part_stem(file), maker_text(maker), part_ending);
}

bool is_part_name(const std::string& name) { return name.starts_with('.') && name.ends_with(part_ending); }

void sweep_parts_of(const fs::path& file) {
    const std::string stem = part_stem(file);
    sweep(file.has_parent_path() ? file.parent_path() : fs::path("."),
          [&](const std::string& name) { return name.starts_with(stem); });
}

void sweep_parts(const fs::path& folder) {
    const std::string host = host_part();
    sweep(folder, [&](const std::string& name) { return name.find(host) != std::string::npos; });
}

}  // namespace voxtone::io
