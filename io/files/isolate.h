// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs a parser of untrusted data in a forked child process with a budget of memory and time.
//
// Parsers (ours and other people's) may crash, hang or eat memory on a file made to do so. In a child that costs an
// error message and not the job. The child works, packs its result into bytes and leaves them in a memory file; the
// parent waits. What the work throws as `Error` is thrown again in the parent with its exit code; everything else that
// can happen to the child (a signal, no memory, no time) becomes an InputError that says so.
//
// The limit of memory is on address space (RLIMIT_AS), `memory_bytes` above what the program has mapped at the fork; a
// sanitizer's shadow memory is larger than any budget, so it must be 0 (none) there. Only the calling thread exists in
// the child: the work must not wait for other threads, nor for a lock that another thread held at the fork.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "voxtone/base/progress.h"

namespace voxtone::io {

struct IsolationLimits {
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< 0: no limit
    double timeout_s = 120;                               ///< wall clock; > 0
};

/// `what` names the file in messages ("spot.obj"). Throws Error, InputError, Cancelled; ResourceError when no process
/// can be made.
[[nodiscard]] std::vector<std::byte> run_isolated(const std::string& what, const IsolationLimits& limits,
                                                  const std::function<std::vector<std::byte>()>& work,
                                                  const Progress* progress = nullptr);

/// True in builds whose memory cannot be limited (address sanitizer).
[[nodiscard]] bool built_with_address_sanitizer();

}  // namespace voxtone::io
