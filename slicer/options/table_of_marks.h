// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels and decals. A part of the option table (option_table.h).
#pragma once

#include <vector>

#include "slicer/options/option_spec.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<OptionSpec> table_of_marks();

}  // namespace voxtone::slicer
