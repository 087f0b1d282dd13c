// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/scratch_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"

namespace voxtone::io {
namespace {

/// Not all file systems have files without names (NFS): there a file loses its name at once.
int open_unnamed(const std::filesystem::path& folder) {
    constexpr mode_t ours = 0600;
    const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, ours);
    if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
    std::string name = (folder / ".voxtone-scratch-XXXXXX").string();
    const int named = ::mkostemp(name.data(), O_CLOEXEC);
    if (named >= 0) ::unlink(name.c_str());
    return named;
}

}  // namespace

ScratchFile::ScratchFile(const std::filesystem::path& folder) : folder_(folder), file_(open_unnamed(folder)) {
    if (!file_)
        fail_to_write(folder_, "what does not fit into memory cannot be put on this disk; allow more memory (--memory)",
                      errno);
}

void ScratchFile::write(std::uint64_t at, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_to_write(folder_, "what does not fit into memory could not be put on this disk", errno);
        at += static_cast<std::uint64_t>(written);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void ScratchFile::read(std::uint64_t at, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t read = ::pread(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (read < 0 && errno == EINTR) continue;
        if (read <= 0)
            throw FileError(fmt::format("{}: what was put on this disk for want of memory could not be read back ({})",
                                        folder_.string(), read == 0 ? "it has ended" : std::strerror(errno)));
        at += static_cast<std::uint64_t>(read);
        bytes = bytes.subspan(static_cast<std::size_t>(read));
    }
}

}  // namespace voxtone::io
