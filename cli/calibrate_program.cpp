// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/cli/calibrate_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/files/helper_program.h"

namespace voxtone::cli {

bool is_for_calibrate(const Words& words) {
    const std::size_t verb = !words.empty() && words[0] == "complete" ? 1 : 0;
    return words.size() > verb && words[verb] == "calibrate" && (verb == 0 || words.size() > 2);
}

void become_calibrate_program(const char* program, Words words) {
    const std::string file = io::find_helper("voxtone-calibrate").string();
    std::string name = program;
    std::vector<char*> argv{name.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(file.c_str(), argv.data());
    throw FileError(fmt::format("{} cannot be run ({}); install voxtone again", file, std::strerror(errno)));
}

Command add_calibrate_mention(CLI::App& program) {
    program.add_subcommand("calibrate", calibrate_description);
    return [] { return static_cast<int>(ExitCode::usage); };
}

}  // namespace voxtone::cli
