// SPDX-License-Identifier: GPL-3.0-or-later
//
// A warning ends with the name of its kind, "... left aside. [no-volume]": docs/messages/warnings.md has the remedy
// under it, and a test refuses one without a name or a remedy.
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace voxtone {

/// The sentence with the name behind it.
[[nodiscard]] inline std::string named_warning(std::string_view name, std::string sentence) {
    return std::move(sentence.append(" [").append(name).append("]"));
}

/// What stands in brackets at the end of a message; empty: nothing does.
[[nodiscard]] constexpr std::string_view message_name(std::string_view message) {
    const std::size_t from = message.rfind('[');
    if (from == std::string_view::npos || !message.ends_with(']')) return {};
    return message.substr(from + 1, message.size() - from - 2);
}

}  // namespace voxtone
