// SPDX-License-Identifier: GPL-3.0-or-later
//
// What to tell a user whose file has a key that nobody knows: a key that is ignored silently is a setting that is lost.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace voxtone::io {

/// The known name with the smallest edit distance (Damerau-Levenshtein with adjacent swaps, Unicode as bytes), the
/// first of several; a name that begins the other ("pitch", "pitch_um") is at distance 1. Empty when none is near: more
/// than half of the letters would have to change.
[[nodiscard]] std::string nearest_name(std::string_view name, std::span<const std::string> known);

/// "unknown key 'pich_um'; did you mean 'pitch_um'?" or, when none is near, the list of all known keys.
[[nodiscard]] std::string unknown_key_message(std::string_view key, std::span<const std::string> known);

}  // namespace voxtone::io
