// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/former_option.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/error.h"

namespace voxtone::cli {

void FormerOption::add(CLI::App& command, const std::string& option, const std::string& former, std::string& value) {
    command_ = &command;
    option_ = option;
    former_ = former;
    command.add_option_function<std::string>(former, [&value](const std::string& word) { value = word; })->group("");
}

void FormerOption::warn(Progress& progress) const {
    if (!command_ || command_->count(former_) == 0) return;
    if (command_->count(option_) > 0)
        throw UsageError(fmt::format("{} is what {} was called earlier, and both are given: leave {} out", former_,
                                     option_, former_));
    progress.note(fmt::format("{} is called {} now, which means the same; it was taken", former_, option_));
}

}  // namespace voxtone::cli
