// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading a ZIP archive that is not trusted, part by part, through libzip. Nothing is unpacked onto the disk. Sizes are
// checked as declared and as they turn out, memory grows as bytes come, and checksums are checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

/// What parts may unpack to. Besides, a part over 64 MiB may not claim more than 200 times its packed size.
struct ZipLimits {
    std::uint64_t part_bytes = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t total_bytes = std::numeric_limits<std::uint64_t>::max();  ///< of all parts together, as declared
};

/// A file in an archive by one path: "a.zip/b/c.obj" is b/c.obj in a.zip.
struct PathInZip {
    std::filesystem::path file;  ///< of the disk
    std::string inner{};         ///< empty: the file itself
    bool is_zip = false;         ///< by its name; else `file` is the whole path
};
/// Where a part of the path is an archive, and no folder, the rest is inside; a path that ends as an archive's is one.
[[nodiscard]] PathInZip path_in_zip(const std::filesystem::path& path);

class ZipReader {
public:
    /// Throws FileError where the file cannot be read, InputError where it is no archive or declares too much in all.
    explicit ZipReader(const std::filesystem::path& file, const ZipLimits& limits = {});
    /// `bytes` must outlive the reader; `name` is for messages.
    ZipReader(std::span<const std::byte> bytes, std::string name, const ZipLimits& limits = {});
    ~ZipReader();

    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    /// Index of a part; a leading '/' is ignored, and upper and lower case where no name fits exactly.
    [[nodiscard]] std::optional<std::size_t> find(const std::string& part) const;
    /// In bytes, as a part declares it; 0 where it declares none.
    [[nodiscard]] std::uint64_t size(std::size_t index) const;
    /// A part's contents, of `most` bytes where that is less than the limits. From any thread, one at a time. Throws
    /// InputError where it claims or has more, has no size or is damaged.
    [[nodiscard]] std::vector<std::uint8_t> read(std::size_t index, std::uint64_t most) const;
    /// The same within the limits alone.
    [[nodiscard]] std::vector<std::byte> read(std::size_t index) const;
    /// The same of the part that `find` finds, if there is one.
    [[nodiscard]] std::optional<std::vector<std::byte>> read(const std::string& part) const;

private:
    struct Handle;
    void list_parts();
    template <class Byte>
    std::vector<Byte> unpack(std::size_t index, std::uint64_t most) const;
    [[nodiscard]] std::uint64_t checked_size(std::size_t index, std::uint64_t most, const std::string& part) const;

    std::string name_;
    ZipLimits limits_;
    std::unique_ptr<Handle> handle_;
    std::vector<std::string> names_;
};

}  // namespace voxtone::io
