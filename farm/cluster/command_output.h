// SPDX-License-Identifier: GPL-3.0-or-later
//
// Other programs' commands: run to their end, with what they said.
#pragma once

#include <span>
#include <string>

namespace voxtone::farm {

struct CommandOutput {
    static constexpr int no_such_program = 127;
    int exit_code = 0;  ///< no_such_program where that is so; -1 where a signal ended it
    std::string out, err;

    /// What it said of its failure, in one line.
    [[nodiscard]] std::string reason() const;
};

/// `command`: the program, looked for in PATH, and its arguments. Throws TryAgain where the system makes no process,
/// ResourceError where command and environment are longer than the system takes for one (E2BIG), FileError where the
/// program is there and cannot be run.
[[nodiscard]] CommandOutput run_command(std::span<const std::string> command);

}  // namespace voxtone::farm
