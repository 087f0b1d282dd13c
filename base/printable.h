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

/// Any bytes as valid UTF-8 that tells them again: each byte that does not belong, from 0x80 on, becomes the character
/// of the private use area U+EF80 + (byte - 0x80), as in MirBSD's OPTU-8; and so does each byte of such a character
/// itself. What is UTF-8 without them stays as it is.
[[nodiscard]] std::string escaped_bytes(std::string_view bytes);
/// The bytes that were escaped.
[[nodiscard]] std::string unescaped_bytes(std::string_view text);

/// A JSON string with its quotes (RFC 8259): escaped_bytes, with quotes, backslashes and control characters escaped.
[[nodiscard]] std::string json_quoted(std::string_view text);

}  // namespace voxtone
