// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes made smaller with zlib, in files of our own and in parts of others.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voxtone::io {

/// `level`: 1 (fast) to 9 (small).
[[nodiscard]] std::vector<std::byte> deflated(std::span<const std::byte> bytes, int level);

/// What was deflated. Throws InputError where it does not give `size` bytes; no more than these are taken of memory.
[[nodiscard]] std::vector<std::byte> inflated(std::span<const std::byte> bytes, std::size_t size);
/// The same where nothing says how large it is. Throws InputError where it is damaged or has more than `most` bytes.
[[nodiscard]] std::vector<std::byte> inflated_up_to(std::span<const std::byte> bytes, std::size_t most);
/// What gzip packed, all of its members. Throws InputError as the one above.
[[nodiscard]] std::vector<std::byte> gunzipped(std::span<const std::byte> bytes, std::size_t most);

}  // namespace voxtone::io
