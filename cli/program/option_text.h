// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is said of an option wherever options are told of: --help, the manual, the shell's completion.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace voxtone::cli {

struct OptionText {
    std::string names;                 ///< "-o, --out"; of a positional argument its own
    std::string value;                 ///< "LENGTH", "FILE..."; empty for a flag
    std::string help;                  ///< what it does, its choices and range, its default
    std::vector<std::string> choices;  ///< all that it may be; empty: free
};
[[nodiscard]] OptionText option_text(const CLI::Option& option, bool positional);

/// Options of a command under one heading, in the order of their declaration.
struct OptionGroup {
    std::string heading;
    bool rare = false;  ///< told by --help-all and the manual only
    std::vector<OptionText> options;
};
/// Those that a user may name, positional arguments first.
[[nodiscard]] std::vector<OptionGroup> option_groups(const CLI::App& command);

/// Heading of options that few need; there may be others (option_text.cpp).
inline constexpr const char* fine_tuning = "Fine tuning";

}  // namespace voxtone::cli
