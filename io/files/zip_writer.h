// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ZIP archive from bytes and files, whole or not there (whole_file.h). All entries have the first date of ZIP, so
// that the same entries give the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "base/progress.h"

namespace voxtone::io {

struct ZipEntry {
    std::string name;
    std::span<const std::uint8_t> bytes{};  ///< must last until the archive is written
    std::filesystem::path file{};           ///< instead of bytes, where it is not empty
    bool deflate = false;                   ///< pictures are compressed already
};

/// Throws FileError, TryAgain where the disk is full, Cancelled.
void write_zip(const std::filesystem::path& file, std::span<const ZipEntry> entries, const Progress* progress);

}  // namespace voxtone::io
