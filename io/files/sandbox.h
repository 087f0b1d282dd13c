// SPDX-License-Identifier: GPL-3.0-or-later
//
// The walls around a process that parses what is not trusted: once they stand, it can read the files that it was
// given, compute, and answer, and nothing else. They hold for good (no_new_privs) and are three, because each stops
// what the others cannot see:
//
// - System calls (seccomp): a list of what is allowed, for what is not thought of must be refused: no writing or making
//   of files, no sockets, no processes or threads, no programs, no tracing, no memory that is both written and run. A
//   refused call fails with EPERM, so that a library that tries something needless goes on without it; one that is
//   newer than the list with ENOSYS, as on an older kernel, so that it takes the older way. Threads are allowed to who
//   asks for them.
// - Files (Landlock, Linux 5.13): open and list only below the paths given; the filter of calls cannot see names.
// - Limits (rlimit): bytes of a file, open files, processes, core dumps, address space.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>

namespace voxtone::io {

/// Walls that this system has no means for, as bits: what `raise_walls` could not do.
enum MissingWall : std::uint8_t { no_call_filter = 1, no_file_filter = 2 };

/// Paths that may be opened for reading: files, and folders with all that is below them; and folders whose names, and
/// those of all folders below, may be listed. Those that are not there are left out.
struct WallDoors {
    std::span<const std::string> readable = {};
    std::span<const std::string> listable = {};
};

struct WallLimits {
    std::uint64_t memory_bytes = 0;  ///< address space beyond what is mapped already; 0: no limit
    std::uint64_t file_bytes = 0;    ///< the longest file that may be written: the answer
    bool threads = false;            ///< may be started; walls hold for them, too
};

/// To be called in a process of one thread: with several it gets no filter of files. Returns MissingWall bits.
std::uint8_t raise_walls(const WallDoors& doors, const WallLimits& limits);

/// Whether the address space was limited from outside more tightly than `raise_walls` was asked to.
[[nodiscard]] bool memory_was_limited_outside();

/// In words, for those who run the program; empty where no wall is missing.
[[nodiscard]] std::string missing_walls_note(std::uint8_t missing);

/// What was told of missing walls. They are the system's, and so the same for every file: once is enough.
class ToldWalls {
public:
    /// In words what of `missing` no call named before; empty: nothing. Threads may call it at once.
    [[nodiscard]] std::string note(std::uint8_t missing) {
        return missing_walls_note(static_cast<std::uint8_t>(missing & ~told_.fetch_or(missing)));
    }

private:
    std::atomic<std::uint8_t> told_ = 0;
};

/// Those of this run.
[[nodiscard]] ToldWalls& told_walls();

}  // namespace voxtone::io
