// SPDX-License-Identifier: GPL-3.0-or-later
//
// --help and --help-all: options under their headings, wrapped, with units, choices and defaults in words.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace voxtone::cli {

/// To be called before commands are added: they take --help, --help-all and their looks from the program.
void set_up_help(CLI::App& program);

/// A command line that a user could try, without the program's name; --help and the manual end with it.
void add_example(CLI::App& command, const std::string& arguments);

/// Broken between words so that no line is longer than this, where its words are not.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

}  // namespace voxtone::cli
