// SPDX-License-Identifier: GPL-3.0-or-later
//
// The far end of io/files/isolate.h: what a program does that works on untrusted data for another one.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace voxtone::io {

/// Lowers the limit of memory to what was asked for, does the work on the request, leaves its result (or the error that
/// it threw) and ends the process. Returns only when it was started by hand and has no request.
void serve_isolated(const std::function<std::vector<std::byte>(std::span<const std::byte> request)>& work);

}  // namespace voxtone::io
