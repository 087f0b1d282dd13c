// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that are either whole or not there under their name, also after a kill or a power cut: written under a
// temporary name beside it, synced, then renamed. The temporary name carries host and process and is opened
// exclusively and locked, so that two jobs never write into one; what a killed job left is swept by the next that
// writes the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

/// Name of the file while this process writes it: ".NAME.HOST.SPACE-PID-START.part" in the same folder.
[[nodiscard]] std::filesystem::path part_path(const std::filesystem::path& file);

/// Throws FileError naming the file and the system's reason, TryAgain where the disk is full; then nothing is left
/// under the temporary name, and under the file's own what was there before.
void write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);
void write_whole_file(const std::filesystem::path& file, std::string_view text);

/// A file of a folder that is published as a whole (stack_folder.h): under its own name at once, not synced, and never
/// in the place of another. Throws like `write_whole_file`.
void write_staged_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);
void write_staged_file(const std::filesystem::path& file, std::string_view text);

/// Syncs and renames what was written under part_path(file). Throws like `write_whole_file`.
void finish_part(const std::filesystem::path& file);

/// All bytes of a file of at most `most` bytes. Throws FileError.
[[nodiscard]] std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& file, std::uint64_t most);

}  // namespace voxtone::io
