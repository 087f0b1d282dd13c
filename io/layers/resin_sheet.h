// SPDX-License-Identifier: GPL-3.0-or-later
//
// The resin assignment sheet for the person at the printer: resins are assigned to colours by hand in its software.
#pragma once

#include <string>

#include "io/layers/manifest.h"

namespace voxtone::io {

[[nodiscard]] std::string resin_sheet_text(const StackDescription& stack);
/// One page without anything from outside; fit to be printed.
[[nodiscard]] std::string resin_sheet_html(const StackDescription& stack);

}  // namespace voxtone::io
