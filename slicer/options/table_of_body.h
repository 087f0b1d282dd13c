// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is printed and where: files, placement, the body's repair. A part of the option table (option_table.h).
#pragma once

#include <vector>

#include "slicer/options/option_spec.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<OptionSpec> table_of_body();

}  // namespace voxtone::slicer
