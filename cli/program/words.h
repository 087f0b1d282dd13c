// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the user typed: the words behind the program's name, and what to say of those that it does not understand.
#pragma once

#include <string>
#include <vector>

#include "cli/program/outcome.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace voxtone::cli {

using Words = std::vector<std::string>;

/// The words, with other programs' habits put into ours: `help VERB` is `VERB --help`, `-o=FOLDER` is `-oFOLDER`.
[[nodiscard]] Words command_words(int argc, char* const* argv);

/// How errors are to be told, also those of a command line that cannot be parsed.
[[nodiscard]] Messages asked_messages(const Words& words);

/// Before the words are parsed: throws UsageError for a verb or a step that there is not, with the nearest that there
/// is, and for an option whose value is missing because another option follows.
void check_words(const CLI::App& program, const Words& words);

/// What is wrong with a command line that CLI11 refused, in one sentence that names the word and the nearest option.
[[nodiscard]] std::string usage_message(const CLI::App& program, const CLI::ParseError& error);

/// "voxtone laminate search".
[[nodiscard]] std::string full_name(const CLI::App& command);

}  // namespace voxtone::cli
