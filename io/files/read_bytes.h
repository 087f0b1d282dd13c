// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::io {

/// The whole file; throws FileError, and InputError when it is larger than `max_bytes`.
[[nodiscard]] std::vector<std::byte> read_bytes(const std::filesystem::path& path, std::uint64_t max_bytes);

/// The same as UTF-8 (io/files/utf8.h).
[[nodiscard]] std::string read_text(const std::filesystem::path& path, std::uint64_t max_bytes);

}  // namespace voxtone::io
