// SPDX-License-Identifier: GPL-3.0-or-later
//
// Room on the disk: asked for before hours are spent, and told apart from faults of a file when it runs out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace voxtone::io {

/// Bytes that we may still write where `path` is, or would be once its folders are made. Nothing where the system does
/// not say. Quotas are not seen.
[[nodiscard]] std::optional<std::uint64_t> free_disk_bytes(const std::filesystem::path& path);

/// "123 MB".
[[nodiscard]] std::string bytes_text(std::uint64_t bytes);

/// Throws TryAgain where less than `bytes` are free at `path`; `what` needs them: "the layers".
void expect_disk_space(const std::filesystem::path& path, std::uint64_t bytes, const std::string& what);

/// Throws for a failed write, with the system's reason: TryAgain where the disk is full (ENOSPC, EDQUOT), else
/// FileError. `what`: "could not be written".
[[noreturn]] void fail_to_write(const std::filesystem::path& file, const std::string& what, int error);

}  // namespace voxtone::io
