// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/steps.h"

#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/error.h"

namespace voxtone::cli {

Command add_steps(CLI::App& verb, const std::vector<AddStep>& steps) {
    verb.require_subcommand(1);
    auto runs = std::make_shared<std::vector<std::pair<CLI::App*, Command>>>();
    for (const AddStep& add : steps) {
        Command run = add(verb);
        runs->emplace_back(verb.get_subcommands([](CLI::App*) { return true; }).back(), std::move(run));
    }
    return [runs] {
        for (const auto& [step, run] : *runs)
            if (step->parsed()) return run();
        return static_cast<int>(ExitCode::usage);
    };
}

}  // namespace voxtone::cli
