// SPDX-License-Identifier: GPL-3.0-or-later
//
// What CLI11 found wrong with the options of a command, in our words: its own sentences name its insides ("At Most 1
// required but received 2").
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace voxtone::cli {

/// One sentence for every kind of error but ExtrasError: which option, what was given, what it takes.
[[nodiscard]] std::string parser_message(const CLI::App& command, const CLI::ParseError& error);

}  // namespace voxtone::cli
