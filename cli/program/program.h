// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the programs of the command line are: verbs, parsed and run (how that ends: cli/program/outcome.h).
#pragma once

#include <functional>
#include <vector>

#include "cli/program/command.h"
#include "cli/program/words.h"

namespace voxtone::cli {

struct Verb {
    const char* name;
    std::function<Command(CLI::App& program)> add;
    const char* former = nullptr;  ///< an earlier name, taken with a note
};

/// The exit code. Two words that users are not told of come before the verbs: `complete WORD...` prints what may stand
/// next (cli/program/completion.h), `manual FOLDER` writes the pages of program and verbs.
int run_program(const Words& words, const std::vector<Verb>& verbs);

}  // namespace voxtone::cli
