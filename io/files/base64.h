// SPDX-License-Identifier: GPL-3.0-or-later
//
// Base64 of RFC 4648, section 4, with padding, without line ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);
/// What is no digit (padding, line ends) is passed over.
[[nodiscard]] std::vector<std::byte> base64_bytes(std::string_view text);

}  // namespace voxtone::io
