// SPDX-License-Identifier: GPL-3.0-or-later
//
// --help and --help-all: options under their headings, wrapped, with units, choices and defaults in words.
#pragma once

#include <string>

#include "cli/program/verb.h"

namespace voxtone::cli {

/// `all`: with the options that few need, and all steps.
[[nodiscard]] std::string help_text(const Verb& verb, bool all);

/// Broken between words so that no line is longer than this, where its words are not.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

}  // namespace voxtone::cli
