// SPDX-License-Identifier: GPL-3.0-or-later
//
// A folder belongs to one job at a time: FOLDER/.voxtone-lock says to which (host, process, since when).
//
// The file is held with flock, which ends with its process however that ends, and which NFS and Lustre carry between
// hosts. Where a file system knows no such locks, who is written in the file decides: a process of this host holds the
// folder as long as it lives (told by its start time from a later one of the same number), one of another host until
// its file is removed.
#pragma once

#include <filesystem>
#include <string>

#include "voxtone/io/disk/open_file.h"

namespace voxtone::io {

inline constexpr std::string_view lock_name = ".voxtone-lock";

[[nodiscard]] std::string host_name();

class FolderLock {
public:
    /// The folder is there. Throws TryAgain that names the holder, FileError where the folder cannot be written.
    explicit FolderLock(const std::filesystem::path& folder);
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    /// Gives the folder back; the file goes.
    ~FolderLock();

private:
    std::filesystem::path folder_;
    OpenFile file_;
};

}  // namespace voxtone::io
