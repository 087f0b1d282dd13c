// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include "voxtone/cli/stack_commands.h"
namespace voxtone::cli {
Command add_stack_factor_command(CLI::App& stack) {
    stack.add_subcommand("factor", "");
    return [] { return 0; };
}
}  // namespace voxtone::cli
