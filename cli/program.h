// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the programs of the command line are: verbs, parsed, run, and their errors told with the exit code of their
// kind.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "voxtone/cli/commands.h"

namespace voxtone::cli {

struct Verb {
    const char* name;
    Command (*add)(CLI::App& program);
};

/// The exit code.
int run_program(int argc, char** argv, const std::vector<Verb>& verbs);

/// The work's exit code, or that of its error, which is told on stderr.
int guarded(const std::function<int()>& work);

}  // namespace voxtone::cli
