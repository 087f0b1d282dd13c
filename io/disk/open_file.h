// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file descriptor that is closed with its owner, and syncing of what was written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>

namespace voxtone::io {

class OpenFile {
public:
    OpenFile() = default;
    /// Of `open`; -1: none.
    explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
    OpenFile(OpenFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    OpenFile& operator=(OpenFile&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~OpenFile() { (void)close(); }

    [[nodiscard]] explicit operator bool() const { return descriptor_ >= 0; }
    [[nodiscard]] int get() const { return descriptor_; }
    /// False, with errno, where the system could not keep what was written.
    [[nodiscard]] bool close();

private:
    int descriptor_ = -1;
};

/// How many bytes a regular file has that is open, whatever has its name by now. Nothing, with errno, where it is none.
[[nodiscard]] std::optional<std::uint64_t> size_of_open(int descriptor);

/// Makes the names in a folder (empty: the current one) last through a power cut, as far as its file system can.
void sync_folder(const std::filesystem::path& folder);
/// The same for all files of the file system that holds `folder`, in one go: thousands cost little more than one.
void sync_file_system(const std::filesystem::path& folder);

}  // namespace voxtone::io
