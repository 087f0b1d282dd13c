// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the programs of the command line are: verbs, parsed and run (how that ends: cli/program/outcome.h).
#pragma once

#include <vector>

#include "cli/program/verb.h"
#include "cli/program/words.h"

namespace voxtone::cli {

/// The exit code. Two words that users are not told of come before the verbs: `complete WORD...` prints what may stand
/// next (cli/program/completion.h), `manual FOLDER` writes the pages of program and verbs.
int run_program(const Words& words, std::vector<Verb> verbs);

}  // namespace voxtone::cli
