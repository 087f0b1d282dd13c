// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate/calibrate_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/calibrate_jobs.h"
#include "io/programs/helper_program.h"

namespace voxtone::cli {

namespace {

constexpr CalibrateJobs no_jobs;

[[noreturn]] void become_calibrate_program(const char* program, Words words) {
    const std::string file = io::find_helper("voxtone-calibrate").string();
    std::string name = program;
    std::vector<char*> argv{name.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(file.c_str(), argv.data());
    throw FileError(fmt::format("{} cannot be run ({}); install voxtone again", file, std::strerror(errno)));
}

/// What it ran before is kept, for it owns what the options are parsed into.
void become_instead(Verb& verb, const char* program, const Words& words) {
    verb.run = [kept = verb.run, program, words]() -> int { become_calibrate_program(program, words); };
    for (Verb& step : verb.steps) become_instead(step, program, words);
}

}  // namespace

Verb calibrate_elsewhere(const char* program, const Words& words) {
    Verb verb = calibrate_verb(no_jobs);
    become_instead(verb, program, words);
    return verb;
}

Verb compare_elsewhere(const char* program, const Words& words) {
    Verb verb = compare_verb(no_jobs);
    become_instead(verb, program, words);
    return verb;
}

}  // namespace voxtone::cli
