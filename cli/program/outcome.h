// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a run of the program ends: its result on stdout, its error in one sentence on stderr (and with --json as an event
// on stdout as well, with --progress openjd as a message), and the exit code of its kind, whatever was thrown.
#pragma once

#include <functional>
#include <string_view>

namespace voxtone::cli {

/// What a run says on stdout.
enum class Messages {
    text,    ///< the result, for a person
    events,  ///< base/progress_events.h
    openjd,  ///< base/openjd_progress.h
};

/// To stdout. That it took all is asked once, at the end (`guarded`).
void print_out(std::string_view text);

/// The work's exit code, or that of what it threw, which is told, on stdout too where that takes messages. 75 where all
/// went well but stdout did not take the result: a full disk, say.
int guarded(Messages messages, const std::function<int()>& work);

}  // namespace voxtone::cli
