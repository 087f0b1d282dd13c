// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs of many prints.
#pragma once

#include "cli/program/verb.h"

namespace voxtone::cli {

[[nodiscard]] Verb batch_verb();
[[nodiscard]] Verb status_verb();
[[nodiscard]] Verb task_verb();
[[nodiscard]] Verb serve_verb();

}  // namespace voxtone::cli
