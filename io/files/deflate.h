// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes made smaller with zlib, for files of our own.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voxtone::io {

/// `level`: 1 (fast) to 9 (small).
[[nodiscard]] std::vector<std::byte> deflated(std::span<const std::byte> bytes, int level);

/// What was deflated. Throws InputError where it does not give `size` bytes; no more than these are taken of memory.
[[nodiscard]] std::vector<std::byte> inflated(std::span<const std::byte> bytes, std::size_t size);

}  // namespace voxtone::io
