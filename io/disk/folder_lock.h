// SPDX-License-Identifier: GPL-3.0-or-later
//
// A folder belongs to one job at a time: FOLDER/.voxtone-lock says to which (host, process, since when).
//
// The file is held with flock, which ends with its process however that ends, and which NFS and Lustre carry between
// hosts. Where a file system knows no such locks, who is written in the file decides: a process of this host holds the
// folder as long as it lives (told by its start time from a later one of the same number), one of another host or
// container until its file is removed. A file system that gives out locks and does not carry them between hosts (Lustre
// with localflock) cannot be told from one that does: who finds a line of another host that is younger than a minute is
// told of it (`doubt`).
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/disk/open_file.h"

namespace voxtone::io {

inline constexpr std::string_view lock_name = ".voxtone-lock";

[[nodiscard]] std::string host_name();

/// Tells processes that see one another by their numbers from all others, where several containers have one host name:
/// eight hexadecimal digits of this start of the machine and of this space of process numbers.
[[nodiscard]] const std::string& process_space();

/// When a process of this host began, in the kernel's ticks since the machine started: tells it from a later one of the
/// same number. 0: there is none of that number, or it has ended and nobody has asked how: what is killed in a
/// container whose first process waits for none stays on the list.
[[nodiscard]] std::uint64_t start_of_process(pid_t pid);

/// Another process holds it.
class FolderHeld : public TryAgain {
public:
    using TryAgain::TryAgain;
};

class FolderLock {
public:
    /// The folder is there; `name`: of the file, where something in the folder is locked and not all of it. Throws
    /// FolderHeld that names the holder, FileError where the folder cannot be written, TryAgain where the disk is full.
    explicit FolderLock(const std::filesystem::path& folder, std::string_view name = lock_name);
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    /// Gives the folder back; the file goes.
    ~FolderLock();

    /// What holds it. A process that inherits this keeps the lock when its parent ends.
    [[nodiscard]] int descriptor() const { return file_.get(); }
    /// Why it may be that another holds it too, in a sentence; empty: nothing speaks for that.
    [[nodiscard]] const std::string& doubt() const { return doubt_; }

private:
    std::filesystem::path path_;
    OpenFile file_;
    std::string doubt_;
};

}  // namespace voxtone::io
