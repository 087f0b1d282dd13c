// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "io/lettering/code_symbol.h"

namespace voxtone::io {

/// As make_code, for the kinds of GS1.
[[nodiscard]] CodeSymbol make_gs1_code(CodeKind kind, const std::string& text);

}  // namespace voxtone::io
