// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/disk_space.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::io {

namespace fs = std::filesystem;

std::optional<std::uint64_t> free_disk_bytes(const fs::path& path) {
    std::error_code error;
    for (fs::path at = fs::absolute(path, error); !error; at = at.parent_path()) {
        const fs::space_info space = fs::space(at, error);
        if (!error) return space.available;
        if (error != std::errc::no_such_file_or_directory || at == at.parent_path()) break;
        error.clear();
    }
    return std::nullopt;
}

std::string bytes_text(std::uint64_t bytes) {
    const double megabytes = static_cast<double>(bytes) * 1e-6;
    if (megabytes >= 1e4) return fmt::format("{:.0f} GB", megabytes * 1e-3);
    if (megabytes >= 1e3) return fmt::format("{:.1f} GB", megabytes * 1e-3);
    return megabytes >= 10 ? fmt::format("{:.0f} MB", megabytes) : fmt::format("{:.1f} MB", megabytes);
}

void expect_disk_space(const fs::path& path, std::uint64_t bytes, const std::string& what) {
    const std::optional<std::uint64_t> free = free_disk_bytes(path);
    if (!free || *free >= bytes) return;
    throw TryAgain(
        fmt::format("{}: the disk has {} free, {} need about {}; free some space or name a folder on another disk",
                    path.string(), bytes_text(*free), what, bytes_text(bytes)));
}

void fail_to_write(const fs::path& file, const std::string& what, int error) {
    if (error == ENOSPC || error == EDQUOT) {
        const std::optional<std::uint64_t> free = free_disk_bytes(file);
        throw TryAgain(
            fmt::format("{}: {}, the disk is full ({}{}); free some space or write to another disk, then run it again",
                        file.string(), what, std::strerror(error),
                        free ? fmt::format(", {} free", bytes_text(*free)) : std::string()));
    }
    if (error == EXDEV)  // all that we move stays within its file system
        throw FileError(
            fmt::format("{}: {} ({}): a folder that came with a container's image cannot be moved (overlayfs); nothing "
                        "was lost; write to a mounted volume, or to a folder that is not there yet",
                        file.string(), what, std::strerror(error)));
    throw FileError(fmt::format("{}: {} ({})", file.string(), what, std::strerror(error)));
}

}  // namespace voxtone::io
