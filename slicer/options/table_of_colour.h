// SPDX-License-Identifier: GPL-3.0-or-later
//
// What colours a print shows: resins, appearance loop, prediction. A part of the option table (option_table.h).
#pragma once

#include <vector>

#include "slicer/options/option_spec.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<OptionSpec> table_of_colour();

}  // namespace voxtone::slicer
