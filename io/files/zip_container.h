// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading a ZIP file entry by entry, with limits; nothing is ever unpacked onto the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace voxtone::io {

class ZipContainer {
public:
    /// Throws FileError, InputError.
    explicit ZipContainer(const std::filesystem::path& file);
    ~ZipContainer();

    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    /// An entry's bytes; the checksum is checked. From any thread, one at a time. Throws InputError where it claims or
    /// has more than `most` bytes or is damaged.
    [[nodiscard]] std::vector<std::uint8_t> read(std::size_t index, std::uint64_t most) const;

private:
    struct Handle;
    std::string path_;
    std::unique_ptr<Handle> handle_;
    std::vector<std::string> names_;
};

}  // namespace voxtone::io
