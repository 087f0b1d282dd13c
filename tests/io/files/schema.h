// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

/// What is wrong with a JSON text by data/schema/NAME.schema.json (JSON Schema, draft 7); empty: nothing. Throws where
/// the text is no JSON.
[[nodiscard]] std::vector<std::string> schema_faults(const std::string& name, std::string_view json);

}  // namespace voxtone::io
