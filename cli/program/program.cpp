// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/program.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "cli/program/completion.h"
#include "cli/program/help.h"
#include "cli/program/licences.h"
#include "cli/program/manual.h"
#include "cli/program/option_schema.h"
#include "cli/program/outcome.h"
#include "io/programs/build_identity.h"

extern const char voxtone_build_commit[];  // a file that the build makes (cmake/write_build_commit.cmake)

namespace voxtone::cli {

namespace {

constexpr const char* description =
    "voxtone turns textured models and pictures into layer bitmaps for full-colour material-jetting printers.\n"
    "Exit codes: 0 done; 1 a bug; 2 usage; 3 invalid input or job; 4 a file could not be read or written; "
    "5 could not finish (memory, cancelled); 6 a check found faults; 75 nothing is wrong with the job, try again; "
    "85 stopped on request, progress saved, run it again.";

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

int print_text(const std::string& text) {
    print_out(text);
    return 0;
}

int print_completions(const CLI::App& program, const Words& words) {
    std::string text;
    for (const std::string& word : completions(program, words)) text += word + "\n";
    return print_text(text);
}

int print_manual(const CLI::App& program, const std::string& folder) {
    std::vector<ManualPage> pages{program_page(program)};
    for (const CLI::App* verb : program.get_subcommands({})) pages.push_back(verb_page(*verb));
    write_manual(pages, folder);
    return 0;
}

/// Of people, of the history of the sources where it is known, and of the build.
std::string version_text() {
    const std::string commit = voxtone_build_commit;
    return fmt::format("voxtone {} ({}build {})", io::program_version(), commit.empty() ? "" : commit + ", ",
                       io::build_digest());
}

/// With the name that its verb has now.
Words by_names_of_now(Words words, const std::vector<Verb>& verbs) {
    for (const Verb& verb : verbs)
        if (!words.empty() && verb.former && words[0] == verb.former) {
            const bool quiet = std::ranges::find(words, "--quiet") != words.end();
            if (!quiet)
                fmt::print(stderr, "voxtone {} is called voxtone {} now, which means the same\n", verb.former,
                           verb.name);
            words[0] = verb.name;
        }
    return words;
}

int run(const Words& said, const std::vector<Verb>& verbs) {
    const Words words = by_names_of_now(said, verbs);
    CLI::App program(description, "voxtone");
    set_up_help(program);
    program.set_version_flag("--version", version_text(), "print the version and stop");
    const std::string json_help = "print every verb and option as one JSON object, and stop";
    const std::string licences_help = "print under which licences voxtone and its libraries are, and stop";
    program.add_flag("--help-json", json_help);
    program.add_flag("--licences", licences_help);
    program.require_subcommand(1);
    add_example(program, "slice spot.obj --size 60mm -o print");
    Commands commands;
    for (const Verb& verb : verbs) commands.emplace_back(verb.name, verb.add(program));
    if (!words.empty() && words[0] == "complete") return print_completions(program, {words.begin() + 1, words.end()});
    if (words.size() == 2 && words[0] == "manual") return print_manual(program, words[1]);
    if (words == Words{"--help-json"}) return print_text(option_schema(program));
    if (words == Words{"--licences"}) return print_text(licences_text());
    check_words(program, words);
    return parse_and_run(program, words, commands);
}

}  // namespace

int run_program(const Words& words, const std::vector<Verb>& verbs) {
    return guarded(asked_messages(words), [&] { return run(words, verbs); });
}

}  // namespace voxtone::cli
