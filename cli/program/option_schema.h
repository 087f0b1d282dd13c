// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every verb and its options as JSON (data/schema/options.schema.json), from the table that makes --help: for programs
// that call this one (python/).
#pragma once

#include <string>

#include "cli/program/verb.h"

namespace voxtone::cli {

/// Of the verbs of `program`, with the steps of families, without what --help does not tell.
[[nodiscard]] std::string option_schema(const Verb& program);

}  // namespace voxtone::cli
