// SPDX-License-Identifier: GPL-3.0-or-later
//
// The SHA-256 of files, one memo for all who ask in a run: a file is read once, and not at all where it is the very
// file that was read before, as its size, its times and its inode say. The system sets the time of change (ctime)
// itself, whatever is done to a file; one that was changed less than two seconds before it was read is read again, as
// clocks of file systems are coarse.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "base/progress.h"

namespace voxtone::io {

/// What tells a file from itself after a change.
struct FileStamp {
    std::uint64_t size = 0, inode = 0;
    std::int64_t modified_ns = 0, changed_ns = 0;  ///< since 1970
    bool operator==(const FileStamp&) const = default;

    /// Nothing where there is no regular file.
    [[nodiscard]] static std::optional<FileStamp> of(const std::string& file);
    /// Whether it was last changed so long ago that a later change cannot look the same.
    [[nodiscard]] bool settled() const;
};

struct KnownDigest {
    FileStamp stamp;
    std::string sha256;
};

/// From any thread.
class FileDigests {
public:
    /// 64 lower-case hexadecimal digits; empty where there is no regular file of that name. Throws FileError where it
    /// cannot be read, Cancelled.
    [[nodiscard]] std::string of(const std::string& file, const Progress* progress = nullptr);

    /// What an earlier run has found out.
    void learn(const std::string& file, const KnownDigest& known);
    /// Nothing where the file was not read, or not long enough after its last change.
    [[nodiscard]] std::optional<KnownDigest> find(const std::string& file) const;

private:
    mutable std::mutex mutex_;
    std::map<std::string, KnownDigest> known_;  ///< by absolute path
};

/// Those of this run.
[[nodiscard]] FileDigests& file_digests();

/// As they say.
[[nodiscard]] std::string file_sha256(const std::filesystem::path& file, const Progress* progress = nullptr);

}  // namespace voxtone::io
