// SPDX-License-Identifier: GPL-3.0-or-later
//
// What may stand next on a command line: the shells ask the program itself (data/completion), so that they know every
// verb, option and choice that it has.
#pragma once

#include <string>
#include <vector>

#include "cli/program/verb.h"
#include "cli/program/words.h"

namespace voxtone::cli {

/// `words`: as typed behind the program's name, the last as far as it is typed (empty: not begun). Words that it may
/// become; of --name=value, what the value may become. None where a file is named or anything goes.
[[nodiscard]] std::vector<std::string> completions(const Verb& program, const Words& words);

}  // namespace voxtone::cli
