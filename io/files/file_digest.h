// SPDX-License-Identifier: GPL-3.0-or-later
//
// The SHA-256 of a file, read piece by piece.
#pragma once

#include <filesystem>
#include <string>

#include "base/progress.h"

namespace voxtone::io {

/// 64 lower-case hexadecimal digits; empty where there is no regular file of that name. Throws FileError where it
/// cannot be read, Cancelled.
[[nodiscard]] std::string file_sha256(const std::filesystem::path& file, const Progress* progress = nullptr);

}  // namespace voxtone::io
