// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text from files on its way to a terminal or into JSON: file and material names may hold anything.
#pragma once

#include <string>
#include <string_view>

namespace voxtone {

/// The text as valid UTF-8: every byte that does not belong becomes U+FFFD (overlong forms and surrogates too).
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// For a terminal: valid UTF-8 without control characters (C0 except line feed and tab, DEL, C1), which become '?'.
/// So no name can move the cursor or set colours.
[[nodiscard]] std::string printable(std::string_view text);

/// A JSON string with its quotes (RFC 8259): valid UTF-8, quotes, backslashes and control characters escaped.
[[nodiscard]] std::string json_quoted(std::string_view text);

}  // namespace voxtone
