// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs of one print: made, foreseen, predicted, checked.
#pragma once

#include "cli/program/verb.h"

namespace voxtone::cli {

[[nodiscard]] Verb slice_verb();
[[nodiscard]] Verb tray_verb();
[[nodiscard]] Verb estimate_verb();
[[nodiscard]] Verb read_verb();
[[nodiscard]] Verb merge_verb();
[[nodiscard]] Verb predict_verb();
[[nodiscard]] Verb proof_verb();
[[nodiscard]] Verb target_verb();
[[nodiscard]] Verb verify_verb();
[[nodiscard]] Verb list_verb();

}  // namespace voxtone::cli
