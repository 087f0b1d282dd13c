// SPDX-License-Identifier: GPL-3.0-or-later
//
// Words to values, by the table of options (verb.h). CLI11 does it, and is known here alone; what it finds wrong is
// told in our words, for its own sentences name its insides ("At Most 1 required but received 2").
#pragma once

#include "cli/program/verb.h"
#include "cli/program/words.h"

namespace voxtone::cli {

/// What the words ask for.
struct Asked {
    enum class What { run, help, help_all, version };
    What what = What::run;
    const Verb* verb = nullptr;  ///< the deepest that they name
};

/// Sets what the verb's options point to. Throws UsageError: which option, what was given, what it takes.
[[nodiscard]] Asked parse(const Verb& program, const Words& words);

}  // namespace voxtone::cli
