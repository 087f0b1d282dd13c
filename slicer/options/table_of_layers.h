// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints of layers that show how light spreads (`--show layered-profile`). A part of the option table (option_table.h).
#pragma once

#include <vector>

#include "slicer/options/option_spec.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<OptionSpec> table_of_layers();

}  // namespace voxtone::slicer
