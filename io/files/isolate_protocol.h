// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the two ends of an isolated program agree on (io/files/isolate.h, io/files/serve_isolated.h).
//
// A request and its answer lie in two memory files; a byte on the line says that one is ready. The first request is
// packed Orders, later ones are bare bytes. An answer is three bytes (Outcome, a code, MissingWall bits), then the
// result or a message. A question is left in the same way, and its Reply comes as a request does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace voxtone::io::isolation {

/// Open files of the program, by number.
inline constexpr int request_fd = 3;
inline constexpr int result_fd = 4;
inline constexpr int line_fd = 5;  ///< a socket; its other end is closed when one of the two has ended

/// `error` has an ExitCode as its code, `not_started` an errno, `no_memory` 1 where the limit came from outside.
enum class Outcome : unsigned char { nothing, result, error, no_memory, unknown, not_started, question };
inline constexpr std::size_t head_bytes = 3;

struct Orders {
    std::uint64_t memory_bytes = 0;     ///< IsolationLimits::memory_bytes
    std::uint64_t result_bytes = 0;     ///< the longest answer
    std::vector<std::string> readable;  ///< IsolationLimits::readable
    std::vector<std::string> listable;  ///< IsolationLimits::listable
    bool threads = false;               ///< IsolationLimits::threads
    std::vector<std::byte> request;
};

template <class Stream, class Value>
requires std::is_same_v<std::remove_const_t<Value>, Orders>
void describe(Stream& stream, Value& o) {
    stream(o.memory_bytes, o.result_bytes, o.readable, o.listable, o.threads, o.request);
}

/// To a question. `refusal` empty: `answer` holds.
struct Reply {
    std::string refusal;
    std::vector<std::byte> answer;
};

template <class Stream, class Value>
requires std::is_same_v<std::remove_const_t<Value>, Reply>
void describe(Stream& stream, Value& r) { stream(r.refusal, r.answer); }

/// Address space for the libraries, before `Orders::memory_bytes` is known to the program.
inline constexpr std::uint64_t loading_bytes = std::uint64_t{4} << 30;

}  // namespace voxtone::io::isolation
