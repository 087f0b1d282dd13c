// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a run of the program ends: its result on stdout, its error in one sentence on stderr (and with --json as an event
// on stdout as well), and the exit code of its kind, whatever was thrown.
#pragma once

#include <functional>
#include <string_view>

namespace voxtone::cli {

/// To stdout. That it took all is asked once, at the end (`guarded`).
void print_out(std::string_view text);

/// The work's exit code, or that of what it threw, which is told; `json`: as an event too. 75 where all went well but
/// stdout did not take the result: a full disk, say.
int guarded(bool json, const std::function<int()>& work);

}  // namespace voxtone::cli
