// SPDX-License-Identifier: GPL-3.0-or-later
//
// What reading a model or a picture may cost: files are taken for hostile.
#pragma once

#include <cstdint>
#include <filesystem>

#include "voxtone/base/progress.h"
#include "voxtone/io/files/isolate.h"

namespace voxtone::io {

struct ReadOptions {
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< what parsing may take; 0: no limit (sanitizers need that)
    double timeout_s = 120;                               ///< > 0
    std::uint64_t max_file_bytes = std::uint64_t{2} << 30;
    std::uint64_t max_pixels = std::uint64_t{1} << 28;          ///< of one picture
    std::uint64_t max_unpacked_bytes = std::uint64_t{2} << 30;  ///< of all of a 3MF's parts
    bool fill_gutters = true;
    std::filesystem::path texture;       ///< of a model: laid on what has coordinates and no picture; empty: none
    const Progress* progress = nullptr;  ///< asked for cancellation
};

/// Throws UsageError naming the option that is out of range.
void validate(const ReadOptions& options);

/// Of the program that parses.
[[nodiscard]] IsolationLimits isolation_limits(const ReadOptions& options);

}  // namespace voxtone::io
