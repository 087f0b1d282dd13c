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

}  // namespace

Command add_calibrate_elsewhere(CLI::App& app, const char* program, const Words& words) {
    // Kept, for it owns what the options of the steps are parsed into.
    return [steps = add_calibrate_command(app, no_jobs), program, words]() -> int {
        become_calibrate_program(program, words);
    };
}

Command add_compare_elsewhere(CLI::App& app, const char* program, const Words& words) {
    return [compare = add_compare_command(app, no_jobs), program, words]() -> int {
        become_calibrate_program(program, words);
    };
}

}  // namespace voxtone::cli
