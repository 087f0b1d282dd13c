// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a job is run: limits of reading, memory, threads, parts of the layers. A part of the option table
// (option_table.h).
#pragma once

#include <vector>

#include "slicer/options/option_spec.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<OptionSpec> table_of_run();

}  // namespace voxtone::slicer
