// SPDX-License-Identifier: GPL-3.0-or-later
//
// Texts and codes of labels may have names in braces, which stand for values of the job ({job}, {part}, {copy}) or of a
// row of a plan; {copy:03} is padded with zeros. "{{" and "}}" are braces. An order sheet has columns that are nobody's
// keys (customer, serial): they are values for labels, and are carried on to where parts are sorted.
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/json_object.h"

namespace voxtone::slicer {

using TemplateValues = std::map<std::string, std::string>;
/// "{serial}", as a key of a plan's row or the header of a column: what stands for the value in labels.
[[nodiscard]] bool is_value_key(std::string_view key);
/// What of a row is its user's own, by the name that stands in braces in labels: keys in braces, and words that are
/// none of the `known` keys and not near to one. Throws InputError for a key that is near to one, and for what is no
/// text.
[[nodiscard]] TemplateValues values_of_row(const io::JsonObject& row, std::span<const std::string> known);
/// Its words that are the user's own without saying so in braces.
[[nodiscard]] std::vector<std::string> own_words(const io::JsonObject& row, std::span<const std::string> known);
/// That they (one at least) are taken so is said: a key in another language than the plan's would be one of them.
[[nodiscard]] std::string own_words_note(const std::set<std::string>& own);

/// A label in whose text these names are replaced by their values; other names stay.
[[nodiscard]] std::string with_values(const std::string& spelled, const TemplateValues& values);
/// Whether its text has this name.
[[nodiscard]] bool names_value(const std::string& spelled, std::string_view name);
/// A text as it is read: doubled braces are one. Throws UsageError for a name, which had no value.
[[nodiscard]] std::string settled_text(const std::string& text, const std::string& said);

}  // namespace voxtone::slicer
