// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/memory_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <new>

#include <fmt/core.h>

namespace voxtone::io {

MemoryFile::MemoryFile(std::span<const std::byte> bytes) : fd_(memfd_create("picture", MFD_CLOEXEC)) {
    for (std::size_t done = 0; fd_ >= 0 && done < bytes.size();) {
        const ssize_t written = write(fd_, bytes.data() + done, bytes.size() - done);
        if (written <= 0) throw std::bad_alloc();
        done += static_cast<std::size_t>(written);
    }
}

MemoryFile::~MemoryFile() {
    if (fd_ >= 0) close(fd_);
}

std::string MemoryFile::path() const { return fmt::format("/proc/self/fd/{}", fd_); }

}  // namespace voxtone::io
