// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the user typed: the words behind the program's name, and what to say of those that it does not understand.
#pragma once

#include <string>
#include <vector>

#include "cli/program/outcome.h"

namespace voxtone::cli {

class Verb;
using Words = std::vector<std::string>;

/// The words, with other programs' habits put into ours: `help VERB` is `VERB --help`, `-o=FOLDER` is `-oFOLDER`.
[[nodiscard]] Words command_words(int argc, char* const* argv);

/// How errors are to be told, also those of a command line that cannot be parsed.
[[nodiscard]] Messages asked_messages(const Words& words);

/// Before the words are parsed: throws UsageError for a verb or a step that there is not, with the nearest that there
/// is, and for an option whose value is missing because another option follows.
void check_words(const Verb& program, const Words& words);

/// What is wrong with words that the verb has no place for: the nearest option, or what it takes. `too_many`: nothing
/// else was found wrong. Empty: nothing is.
[[nodiscard]] std::string unknown_words(const Verb& verb, const Words& words, bool too_many);

}  // namespace voxtone::cli
