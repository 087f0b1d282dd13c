// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone --licences`: data/licences.json, which the bill of materials of a package is made from, too (tools/sbom).
#pragma once

#include <string>

namespace voxtone::cli {

[[nodiscard]] std::string licences_text();

}  // namespace voxtone::cli
