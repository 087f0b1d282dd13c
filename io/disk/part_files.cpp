// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/part_files.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
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

/// Whether the process lives that a temporary name of this host tells of. Its file has no lock for a moment after it
/// was made, so the lock alone does not tell.
bool is_being_written(const std::string& name) {
    const std::string stem = name.substr(0, name.size() - part_ending.size());
    const std::string digits = stem.substr(stem.rfind('.') + 1);
    pid_t process = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), process);
    if (error != std::errc() || end != digits.data() + digits.size() || process <= 0) return false;
    return process != getpid() && (kill(process, 0) == 0 || errno == EPERM);
}

template <class Passes>
void sweep(const fs::path& folder, const Passes& passes) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (!is_part_name(name) || !passes(name) || is_being_written(name)) continue;
        const OpenFile part(::open(entry.path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
        if (part && flock(part.get(), LOCK_EX | LOCK_NB) == 0) fs::remove(entry.path(), ignored);
    }
}

}  // namespace

std::string part_name(const fs::path& file) { return fmt::format("{}{}{}", part_stem(file), getpid(), part_ending); }

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
