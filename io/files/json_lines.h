// SPDX-License-Identifier: GPL-3.0-or-later
//
// On which line of a JSON text something stands, and whether an object has a key twice. nlohmann-json keeps no places
// and takes the last of two keys; so a text that was parsed is walked once more.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace voxtone::io {

/// One step from a value to one within it: a key of an object, or a place in a list.
using JsonStep = std::variant<std::string, std::size_t>;

/// A key that stands in its object before.
struct RepeatedKey {
    std::string key;
    std::size_t line;  ///< of the second
};
/// The first in the text; nothing: there is none. The text must be valid JSON. Time linear in its length, memory that
/// of the keys of the objects that are open at a time.
[[nodiscard]] std::optional<RepeatedKey> repeated_key(std::string_view text);

/// Line, 1 for the first, of the key or list entry at the end of the path; 0 where it is not there. The text must be
/// valid JSON. Time linear in its length, memory none.
[[nodiscard]] std::size_t line_in_json(std::string_view text, std::span<const JsonStep> path);

}  // namespace voxtone::io
