// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate` and `voxtone compare` are done by a program of its own, voxtone-calibrate, for the libraries that
// it loads (cli/calibrate/calibrate_jobs.h). `voxtone` tells of them, and becomes it when one is to be run.
#pragma once

#include "cli/program/command.h"
#include "cli/program/words.h"

namespace voxtone::cli {

/// The verb with its steps. What is given back becomes voxtone-calibrate with these words; `program`: what this one was
/// called by. That comes back only by FileError: the program is missing or cannot be run.
Command add_calibrate_elsewhere(CLI::App& app, const char* program, const Words& words);
Command add_compare_elsewhere(CLI::App& app, const char* program, const Words& words);

}  // namespace voxtone::cli
