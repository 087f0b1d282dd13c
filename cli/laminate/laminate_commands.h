// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate` and its steps, one file each.
#pragma once

#include "cli/program/verb.h"

namespace voxtone::cli {

[[nodiscard]] Verb laminate_verb();

[[nodiscard]] Verb laminate_dataset_verb();
[[nodiscard]] Verb laminate_factor_verb();
[[nodiscard]] Verb laminate_predict_verb();
[[nodiscard]] Verb laminate_print_verb();
[[nodiscard]] Verb laminate_search_verb();
[[nodiscard]] Verb laminate_targets_verb();
[[nodiscard]] Verb laminate_trace_verb();

}  // namespace voxtone::cli
