// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the programs of the command line are: verbs, parsed, run, and their errors told with the exit code of their
// kind: on stderr in one sentence, and with --json as an event on stdout as well.
#pragma once

#include <functional>
#include <vector>

#include "voxtone/cli/commands.h"
#include "voxtone/cli/words.h"

namespace voxtone::cli {

struct Verb {
    const char* name;
    Command (*add)(CLI::App& program);
};

/// The exit code. Two words that users are not told of come before the verbs: `complete WORD...` prints what may stand
/// next (cli/completion.h), `manual FOLDER` writes the pages of the verbs, and of the program where it is `whole`.
int run_program(const Words& words, const std::vector<Verb>& verbs, bool whole);

/// The work's exit code, or that of its error, which is told; 75 where all went well but stdout did not take the
/// result.
int guarded(const Words& words, const std::function<int()>& work);

}  // namespace voxtone::cli
