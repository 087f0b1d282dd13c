// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that are not flat, against Monte Carlo with their true surface: a textured sphere, thin fins.
#pragma once

#include "suite_case.h"

namespace voxtone::accuracy {

[[nodiscard]] std::vector<SuiteCase> body_cases();

}  // namespace voxtone::accuracy
