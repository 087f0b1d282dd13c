// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/cli/program.h"

#include <exception>
#include <new>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"

namespace voxtone::cli {

namespace {

int report(ExitCode code, const std::string& message) {
    fmt::print(stderr, "voxtone: {}\n", message);
    return static_cast<int>(code);
}

int parse_and_run(int argc, char** argv, const std::vector<Verb>& verbs) {
    CLI::App program(
        "voxtone turns textured models and pictures into layer bitmaps for full-colour material-jetting printers.\n"
        "Exit codes: 0 done; 1 a bug; 2 usage; 3 invalid input or job; 4 a file could not be read or written;\n"
        "5 could not finish (memory, cancelled); 6 a check found faults.",
        "voxtone");
    program.set_version_flag("--version", "voxtone " VOXTONE_VERSION);
    program.require_subcommand(1);
    std::vector<std::pair<std::string, Command>> commands;
    for (const Verb& verb : verbs) commands.emplace_back(verb.name, verb.add(program));
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // Help and version come as "errors" with exit code 0.
        return program.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
    for (const auto& [name, command] : commands)
        if (program.got_subcommand(name)) return command();
    return static_cast<int>(ExitCode::usage);
}

}  // namespace

int run_program(int argc, char** argv, const std::vector<Verb>& verbs) {
    return guarded([&] { return parse_and_run(argc, argv, verbs); });
}

int guarded(const std::function<int()>& work) {
    try {
        return work();
    } catch (const Error& error) {
        return report(error.exit_code(), error.what());
    } catch (const std::bad_alloc&) {
        return report(ExitCode::unfinished,
                      "out of memory; use a smaller --size, fewer --threads or a machine with more memory");
    } catch (const ContractViolation& error) {
        return report(ExitCode::bug, fmt::format("a bug of ours, please report it: {}", error.what()));
    } catch (const std::exception& error) {
        return report(ExitCode::bug, fmt::format("an unexpected failure, please report it: {}", error.what()));
    }
}

}  // namespace voxtone::cli
