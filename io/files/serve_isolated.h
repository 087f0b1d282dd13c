// SPDX-License-Identifier: GPL-3.0-or-later
//
// The far end of io/files/isolate.h: what a program does that works on untrusted data for another one.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "io/files/packed_values.h"

namespace voxtone::io {

/// Raises the walls (io/files/sandbox.h), then does the work on one request after the other and leaves each result (or
/// the error that it threw), until no more is to come; then it ends the process. Memory of a result is given back while
/// it is written. Returns only when it was started by
/// hand. The process must have no other thread: it would stay outside the walls.
void serve_isolated(const std::function<Packing(std::span<const std::byte> request)>& work);

/// Amid its work: asks the program that started this one (IsolatedProgram::answer_by), and waits. Throws InputError
/// where it refuses.
[[nodiscard]] std::vector<std::byte> ask_starter(std::span<const std::byte> question);

}  // namespace voxtone::io
