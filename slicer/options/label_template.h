// SPDX-License-Identifier: GPL-3.0-or-later
//
// Texts and codes of labels may have names in braces, which stand for values of the job ({job}, {part}, {copy}) or of a
// row of a plan; {copy:03} is padded with zeros. "{{" and "}}" are braces.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "io/files/json_object.h"

namespace voxtone::slicer {

using TemplateValues = std::map<std::string, std::string>;
/// "{serial}", as a key of a plan's row or the header of a column: what stands for the value in labels.
[[nodiscard]] bool is_value_key(std::string_view key);
[[nodiscard]] TemplateValues template_values(const io::JsonObject& row);

/// A label in whose text these names are replaced by their values; other names stay.
[[nodiscard]] std::string with_values(const std::string& spelled, const TemplateValues& values);
/// Whether its text has this name.
[[nodiscard]] bool names_value(const std::string& spelled, std::string_view name);
/// A text as it is read: doubled braces are one. Throws UsageError for a name, which had no value.
[[nodiscard]] std::string settled_text(const std::string& text, const std::string& said);

}  // namespace voxtone::slicer
