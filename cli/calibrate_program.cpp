// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/cli/calibrate_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/files/helper_program.h"

namespace voxtone::cli {

bool asks_for_calibrate(int argc, char* const* argv) { return argc > 1 && std::string_view(argv[1]) == "calibrate"; }

void become_calibrate_program(char* const* argv) {
    const std::string program = io::find_helper("voxtone-calibrate").string();
    execv(program.c_str(), argv);
    throw FileError(fmt::format("{} cannot be run ({}); install voxtone again", program, std::strerror(errno)));
}

Command add_calibrate_mention(CLI::App& program) {
    program.add_subcommand("calibrate", calibrate_description);
    return [] { return static_cast<int>(ExitCode::usage); };
}

}  // namespace voxtone::cli
