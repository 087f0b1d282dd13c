// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which cartridges a resin set speaks of: the key "family" of its file. Light does not see it; printers name their
// resins by it.
#pragma once

#include <string>

namespace voxtone::io {

/// "Vero Vivid", of a set that find_resin_set finds; empty: its file does not say. Throws as find_resin_set does.
[[nodiscard]] std::string resin_family(const std::string& name_or_file);

}  // namespace voxtone::io
