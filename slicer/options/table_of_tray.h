// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the parts of a tray are laid out. A part of the option table (option_table.h).
#pragma once

#include <vector>

#include "slicer/options/option_spec.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<OptionSpec> table_of_tray();

}  // namespace voxtone::slicer
