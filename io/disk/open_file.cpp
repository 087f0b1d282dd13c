// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/open_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "io/disk/disk_space.h"

namespace voxtone::io {

namespace {

OpenFile open_folder(const std::filesystem::path& folder) {
    return OpenFile(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

}  // namespace

bool OpenFile::close() {
    const int descriptor = std::exchange(descriptor_, -1);
    return descriptor < 0 || ::close(descriptor) == 0;
}

std::optional<std::uint64_t> size_of_open(int descriptor) {
    struct stat about {};
    if (fstat(descriptor, &about) != 0) return std::nullopt;
    if (S_ISREG(about.st_mode)) return static_cast<std::uint64_t>(about.st_size);
    errno = S_ISDIR(about.st_mode) ? EISDIR : ENOTSUP;
    return std::nullopt;
}

void sync_folder(const std::filesystem::path& folder) {
    // Some network file systems cannot, and nothing is to be done about that.
    if (const OpenFile opened = open_folder(folder)) (void)fsync(opened.get());
}

void sync_file_system(const std::filesystem::path& folder) {
    const OpenFile opened = open_folder(folder);
    if (!opened || syncfs(opened.get()) != 0) fail_to_write(folder, "could not be written to the disk", errno);
}

}  // namespace voxtone::io
