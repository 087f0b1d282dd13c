// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate` is a program of its own, voxtone-calibrate: it alone loads OpenCV, for the photographs, and
// Ceres, for the fits. `voxtone` becomes it when it is asked for.
#pragma once

#include "voxtone/cli/commands.h"
#include "voxtone/cli/words.h"

namespace voxtone::cli {

/// In one line; also what voxtone-calibrate says of itself.
inline constexpr const char* calibrate_description =
    "Find the resins' albedo and extinction from one printed and photographed (or measured) target, or measure how "
    "light spreads in a slab";

/// Also of words to be completed (cli/completion.h).
[[nodiscard]] bool is_for_calibrate(const Words& words);

/// With these words; `program`: what this one was called by. Returns only by FileError: the program is missing or
/// cannot be run.
[[noreturn]] void become_calibrate_program(const char* program, Words words);

/// For `voxtone --help`.
Command add_calibrate_mention(CLI::App& program);

}  // namespace voxtone::cli
