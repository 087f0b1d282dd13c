// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/program.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/program/completion.h"
#include "cli/program/help.h"
#include "cli/program/licences.h"
#include "cli/program/manual.h"
#include "cli/program/option_schema.h"
#include "cli/program/outcome.h"
#include "cli/program/parser.h"
#include "io/programs/build_identity.h"

extern const char voxtone_build_commit[];  // a file that the build makes (cmake/write_build_commit.cmake)

namespace voxtone::cli {

namespace {

constexpr const char* description =
    "voxtone turns textured models and pictures into layer bitmaps for full-colour material-jetting printers.\n"
    "Exit codes: 0 done; 1 a bug; 2 usage; 3 invalid input or job; 4 a file could not be read or written; "
    "5 could not finish (memory, cancelled); 6 a check found faults; 75 nothing is wrong with the job, try again; "
    "85 stopped on request, progress saved, run it again.";

int print_text(const std::string& text) {
    print_out(text);
    return 0;
}

int print_completions(const Verb& program, const Words& words) {
    std::string text;
    for (const std::string& word : completions(program, words)) text += word + "\n";
    return print_text(text);
}

int print_manual(const Verb& program, const std::string& folder) {
    std::vector<ManualPage> pages{program_page(program)};
    for (const Verb& verb : program.steps) pages.push_back(verb_page(verb));
    write_manual(pages, folder);
    return 0;
}

/// Of people, of the history of the sources where it is known, and of the build.
std::string version_text() {
    const std::string commit = voxtone_build_commit;
    return fmt::format("voxtone {} ({}build {})", io::program_version(), commit.empty() ? "" : commit + ", ",
                       io::build_digest());
}

int parse_and_run(const Verb& program, const Words& words) {
    const Asked asked = parse(program, words);
    switch (asked.what) {
        case Asked::What::help:
            return print_text(help_text(*asked.verb, false));
        case Asked::What::help_all:
            return print_text(help_text(*asked.verb, true));
        case Asked::What::version:
            return print_text(version_text() + "\n");
        case Asked::What::run:
            break;
    }
    if (asked.verb == &program) throw UsageError("name a verb; `voxtone --help` says which there are");
    return asked.verb->run();
}

int run(const Words& words, std::vector<Verb> verbs) {
    Verb program("voxtone", description, "slice spot.obj --size 60mm -o print");
    program.add("--version", std::monostate(), "print the version and stop");
    program.add("--help-json", std::monostate(), "print every verb and option as one JSON object, and stop");
    program.add("--licences", std::monostate(), "print under which licences voxtone and its libraries are, and stop");
    program.steps = std::move(verbs);
    program.settle({});
    if (!words.empty() && words[0] == "complete") return print_completions(program, {words.begin() + 1, words.end()});
    if (words.size() == 2 && words[0] == "manual") return print_manual(program, words[1]);
    if (words == Words{"--help-json"}) return print_text(option_schema(program));
    if (words == Words{"--licences"}) return print_text(licences_text());
    check_words(program, words);
    return parse_and_run(program, words);
}

}  // namespace

int run_program(const Words& words, std::vector<Verb> verbs) {
    return guarded(asked_messages(words), [&] { return run(words, std::move(verbs)); });
}

}  // namespace voxtone::cli
