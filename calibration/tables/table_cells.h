// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cells of tables that people and measuring programs write: blanks and quotes around them, numbers, names of resins.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::calibration {

/// Without blanks around it, and without one pair of quotes.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// At every `at`, trimmed.
[[nodiscard]] std::vector<std::string_view> split(std::string_view line, char at);
/// At every `at` that is not between quotes, trimmed.
[[nodiscard]] std::vector<std::string_view> split_quoted(std::string_view line, char at);

/// A finite number with a decimal point, and nothing else.
[[nodiscard]] std::optional<double> number(std::string_view text);
/// The same with a decimal point or a decimal comma.
[[nodiscard]] std::optional<double> number_with_comma(std::string_view text);

/// A cell as it is shown in a message: in quotes, no longer than 40 bytes, no control characters.
[[nodiscard]] std::string shown(std::string_view text);
/// Several of them: "\"dE\", \"gloss60\" and 34 more".
[[nodiscard]] std::string shown_list(const std::vector<std::string>& texts);
/// ASCII letters as capitals.
[[nodiscard]] std::string in_capitals(std::string_view text);

/// Whether a text can be the role of a resin: a short word without marks that mixtures and tables use.
[[nodiscard]] bool is_role(std::string_view text);

/// A # before each line of the text.
[[nodiscard]] std::string comment_lines(std::string_view text);

}  // namespace voxtone::calibration
