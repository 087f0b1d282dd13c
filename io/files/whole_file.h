// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that are either whole or not there under their name: written under a temporary name beside it, then renamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

/// Name of the file while it is being written: ".NAME.part" in the same folder.
[[nodiscard]] std::filesystem::path part_path(const std::filesystem::path& file);

/// Throws FileError naming the file and the system's reason; then nothing is left under either name.
void write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);
void write_whole_file(const std::filesystem::path& file, std::string_view text);

/// Renames what was written under part_path(file). Throws FileError.
void finish_part(const std::filesystem::path& file);

/// All bytes of a file of at most `most` bytes. Throws FileError.
[[nodiscard]] std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& file, std::uint64_t most);

}  // namespace voxtone::io
