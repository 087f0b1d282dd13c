// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cases of pure resins in a flat white slab: an edge, dots, lines, gratings.
#pragma once

#include "suite_case.h"

namespace voxtone::accuracy {

[[nodiscard]] std::vector<SuiteCase> flat_cases();

}  // namespace voxtone::accuracy
