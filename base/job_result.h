// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job has to say at its end: every verb of the program is one job, a function `run_..._job(options, progress)`
// that gives this back and throws `Error` for all that is wrong with what it was given.
#pragma once

#include <optional>
#include <string>

#include "base/error.h"

namespace voxtone {

struct JobResult {
    std::string json;  ///< for programs: one object, one line
    std::string text;  ///< for people: one or more lines
    ExitCode exit_code = ExitCode::done;
    /// What --quiet shows of a failure, a line or more; empty: warnings have said it all; nothing: the text.
    std::optional<std::string> failure = {};
};

}  // namespace voxtone
