// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes as an open file without a name on the disk, for readers that want a path.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace voxtone::io {

class MemoryFile {
public:
    /// Throws std::bad_alloc.
    explicit MemoryFile(std::span<const std::byte> bytes);
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile();
    [[nodiscard]] std::string path() const;

private:
    int fd_;
};

}  // namespace voxtone::io
