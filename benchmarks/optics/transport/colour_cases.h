// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cases of flat colours, separated and screened as `slice` does it: hues, greys, thin walls, a clear coat.
#pragma once

#include "suite_case.h"

namespace voxtone::accuracy {

[[nodiscard]] std::vector<SuiteCase> colour_cases();

}  // namespace voxtone::accuracy
