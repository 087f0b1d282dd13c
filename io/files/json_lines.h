// SPDX-License-Identifier: GPL-3.0-or-later
//
// On which line of a JSON text something stands. nlohmann-json keeps no places; so a text that was parsed is walked
// once more, and only when there is a fault to tell.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace voxtone::io {

/// One step from a value to one within it: a key of an object, or a place in a list.
using JsonStep = std::variant<std::string, std::size_t>;

/// Line, 1 for the first, of the key or list entry at the end of the path; 0 where it is not there. Of a key that an
/// object has twice, the last one: that is the one whose value counts. The text must be valid JSON. Time linear in its
/// length, memory none.
[[nodiscard]] std::size_t line_in_json(std::string_view text, std::span<const JsonStep> path);

}  // namespace voxtone::io
