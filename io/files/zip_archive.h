// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading a ZIP archive that is not trusted: sizes are checked as declared and as they turn out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

class ZipArchive {
public:
    /// `bytes` must outlive the archive. `max_unpacked_bytes` is for all parts together. Throws InputError when it is
    /// no archive, or a bomb: parts that declare more, or one over 64 MiB that unpacks to more than 200 times its size.
    ZipArchive(std::span<const std::byte> bytes, std::string name, std::uint64_t max_unpacked_bytes);
    ZipArchive(const ZipArchive&) = delete;
    ZipArchive& operator=(const ZipArchive&) = delete;
    ~ZipArchive();

    /// The contents of a part; a leading '/' is ignored, and upper and lower case where no name fits exactly. Nothing:
    /// no such part. Throws InputError when it is damaged.
    [[nodiscard]] std::optional<std::vector<std::byte>> read(const std::string& part) const;

private:
    struct Handle;
    std::string name_;
    std::unique_ptr<Handle> handle_;
};

}  // namespace voxtone::io
