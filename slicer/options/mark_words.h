// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a mark is spelled: what it shows, then words about it, parted by semicolons:
//
//   {job}-{copy:03}; place=bottom; size=6pt
//   qr=https://example.org/{job}; size=8mm
//   logo.png; place=front; size=20mm; turn=15
// A backslash takes the meaning from the character after it, and "\n" begins a new line of text.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slicer/options/mark_options.h"

namespace voxtone::slicer {

/// Whose words: of `--label` the first word is a text, of `--decal` a picture's file.
enum class MarkFamily : std::uint8_t { label, decal };

/// Key and value of each word, unescaped, the first with the key "text" or "file" where it has none; and back again.
/// Throws UsageError where a word stands within another, without a semicolon: it would be printed with it.
using MarkWords = std::vector<std::pair<std::string, std::string>>;
[[nodiscard]] MarkWords split_mark(MarkFamily family, std::string_view spelled);
[[nodiscard]] std::string spell_mark(const MarkWords& words);

/// Whether a word's key says what the mark shows: "text", "qr", "file" and their like.
[[nodiscard]] bool is_mark_subject(std::string_view key);

/// Throws UsageError for words that are not known, not understood or do not go together. No file is looked at.
[[nodiscard]] MarkOptions parse_mark(MarkFamily family, const std::string& spelled);

/// The same mark where every name of a file is what `place` makes of it; fonts' names are left alone.
[[nodiscard]] std::string with_files(MarkFamily family, const std::string& spelled,
                                     const std::function<std::string(const std::string&)>& place);

}  // namespace voxtone::slicer
