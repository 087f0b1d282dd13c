// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers of things as a person writes them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace voxtone {

/// "1 fault", "2 faults"; for nouns whose plural is an s.
[[nodiscard]] inline std::string counted(std::uint64_t number, std::string_view noun) {
    return std::to_string(number) + " " + std::string(noun) + (number == 1 ? "" : "s");
}

}  // namespace voxtone
