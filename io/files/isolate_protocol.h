// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the two ends of an isolated program agree on (io/files/isolate.h, io/files/serve_isolated.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace voxtone::io::isolation {

/// Open files of the program, by number.
inline constexpr int request_fd = 3;   ///< RequestHead, then the request's bytes
inline constexpr int result_fd = 4;    ///< Outcome, a code, then bytes: the result, or a message
inline constexpr int lifeline_fd = 5;  ///< closed when the program has ended

/// First byte of what the program leaves; `error` has an ExitCode as its second, `not_started` an errno.
enum class Outcome : unsigned char { nothing, result, error, no_memory, unknown, not_started };
inline constexpr std::size_t head_bytes = 2;

struct RequestHead {
    std::uint64_t memory_bytes;  ///< IsolationLimits::memory_bytes
};

/// Address space for the libraries, before `RequestHead::memory_bytes` is known to the program.
inline constexpr std::uint64_t loading_bytes = std::uint64_t{4} << 30;

}  // namespace voxtone::io::isolation
