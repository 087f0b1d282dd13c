// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate` is a program of its own, voxtone-calibrate: it alone loads OpenCV, for the photographs, and
// Ceres, for the fits. `voxtone` becomes it when it is asked for.
#pragma once

#include "voxtone/cli/commands.h"

namespace voxtone::cli {

/// In one line; also what voxtone-calibrate says of itself.
inline constexpr const char* calibrate_description =
    "Find the resins' albedo and extinction from one printed and photographed (or measured) target, or measure how "
    "light spreads in a slab";

[[nodiscard]] bool asks_for_calibrate(int argc, char* const* argv);

/// With the same command line. Returns only by FileError: the program is missing or cannot be run.
[[noreturn]] void become_calibrate_program(char* const* argv);

/// For `voxtone --help`.
Command add_calibrate_mention(CLI::App& program);

}  // namespace voxtone::cli
