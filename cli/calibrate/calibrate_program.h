// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate` and `voxtone compare` are done by a program of its own, voxtone-calibrate, for the libraries that
// it loads (cli/calibrate/calibrate_jobs.h). `voxtone` tells of them, and becomes it when one is to be run.
#pragma once

#include "cli/program/verb.h"
#include "cli/program/words.h"

namespace voxtone::cli {

/// The verb with its steps, which become voxtone-calibrate with these words; `program`: what this one was called by.
/// They come back only by FileError: the program is missing or cannot be run.
[[nodiscard]] Verb calibrate_elsewhere(const char* program, const Words& words);
[[nodiscard]] Verb compare_elsewhere(const char* program, const Words& words);

}  // namespace voxtone::cli
