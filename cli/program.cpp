// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/cli/program.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/printable.h"
#include "voxtone/base/progress_events.h"
#include "voxtone/cli/completion.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/help.h"
#include "voxtone/cli/manual.h"

namespace voxtone::cli {

namespace {

constexpr const char* description =
    "voxtone turns textured models and pictures into layer bitmaps for full-colour material-jetting printers.\n"
    "Exit codes: 0 done; 1 a bug; 2 usage; 3 invalid input or job; 4 a file could not be read or written; "
    "5 could not finish (memory, cancelled); 6 a check found faults; 75 nothing is wrong with the job, try again.";

int tell(bool json, ExitCode code, const std::string& message) {
    std::fputs(printable("voxtone: " + message + "\n").c_str(), stderr);
    if (json) print_out(error_event(code, message) + "\n");
    return static_cast<int>(code);
}

int tell_current_exception(bool json) {
    try {
        throw;
    } catch (const Error& error) {
        return tell(json, error.exit_code(), error.what());
    } catch (const std::bad_alloc&) {
        return tell(json, ExitCode::unfinished,
                    "out of memory; use a smaller --size, fewer --threads or a machine with more memory");
    } catch (const ContractViolation& error) {
        return tell(json, ExitCode::bug, fmt::format("a bug of ours, please report it: {}", error.what()));
    } catch (const std::exception& error) {
        return tell(json, ExitCode::bug, fmt::format("an unexpected failure, please report it: {}", error.what()));
    } catch (...) {
        return tell(json, ExitCode::bug, "an unexpected failure of no known kind, please report it");
    }
}

/// A result that its reader did not get is no success: the disk that stdout goes to may be full.
int noticing_lost_output(int code) {
    constexpr int try_again = 75;  // EX_TEMPFAIL
    const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
    if (!lost) return code;
    std::fputs(fmt::format("voxtone: stdout could not be written ({}), so what was printed there is not whole; files "
                           "that were named are. Make room or choose another place for it\n",
                           std::strerror(errno))
                   .c_str(),
               stderr);
    return code == 0 ? try_again : code;
}

using Commands = std::vector<std::pair<std::string, Command>>;

int parse_and_run(CLI::App& program, const Words& words, const Commands& commands) {
    try {
        program.parse(Words(words.rbegin(), words.rend()));  // CLI11 takes them from the back
    } catch (const CLI::CallForAllHelp&) {
        print_out(program.help("", CLI::AppFormatMode::All));
        return 0;
    } catch (const CLI::CallForHelp&) {
        print_out(program.help());
        return 0;
    } catch (const CLI::CallForVersion& version) {
        print_out(std::string(version.what()) + "\n");
        return 0;
    } catch (const CLI::ParseError& error) {
        throw UsageError(usage_message(program, error));
    }
    for (const auto& [name, command] : commands)
        if (program.got_subcommand(name)) return command();
    throw UsageError("name a verb; `voxtone --help` says which there are");
}

int print_completions(const CLI::App& program, const Words& words) {
    std::string text;
    for (const std::string& word : completions(program, words)) text += word + "\n";
    print_out(text);
    return 0;
}

int print_manual(const CLI::App& program, const std::string& folder, bool whole) {
    std::vector<ManualPage> pages;
    if (whole) pages.push_back(program_page(program));
    for (const CLI::App* verb : program.get_subcommands({}))
        if (!whole || verb->get_name() != "calibrate") pages.push_back(verb_page(*verb));
    write_manual(pages, folder);
    return 0;
}

int run(const Words& words, const std::vector<Verb>& verbs, bool whole) {
    CLI::App program(description, "voxtone");
    set_up_help(program);
    program.set_version_flag("--version", "voxtone " VOXTONE_VERSION, "print the version and stop");
    program.require_subcommand(1);
    Commands commands;
    for (const Verb& verb : verbs) commands.emplace_back(verb.name, verb.add(program));
    if (!words.empty() && words[0] == "complete") return print_completions(program, {words.begin() + 1, words.end()});
    if (words.size() == 2 && words[0] == "manual") return print_manual(program, words[1], whole);
    check_words(program, words);
    return parse_and_run(program, words, commands);
}

}  // namespace

int run_program(const Words& words, const std::vector<Verb>& verbs, bool whole) {
    return guarded(words, [&] { return run(words, verbs, whole); });
}

int guarded(const Words& words, const std::function<int()>& work) {
    int code;
    try {
        code = work();
    } catch (...) {
        code = tell_current_exception(asks_for_json(words));
    }
    return noticing_lost_output(code);
}

}  // namespace voxtone::cli
