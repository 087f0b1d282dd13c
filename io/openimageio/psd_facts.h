// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a Photoshop file says of itself that OpenImageIO does not tell.
// Source: Adobe Photoshop File Formats Specification, 2019: file header; image resources 1047 and 1057; layer records.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voxtone::io {

struct PsdFacts {
    bool is_cmyk = false;
    bool says_unmerged = false;  ///< that its picture of all layers together is none (saved without compatibility)
    std::vector<bool> hidden{};  ///< of its layers, as they stand in the file; those of 16 bits are not listed
};

/// Of a file that is cut short what could be read.
[[nodiscard]] PsdFacts psd_facts(std::span<const std::byte> file);

/// A file of a palette that does not say which index is transparent, saying that 256 is, which is none: of others
/// OpenImageIO 2.4 promises four channels and gives three. Empty: it is no such file.
[[nodiscard]] std::vector<std::byte> with_transparent_index(std::span<const std::byte> file);

}  // namespace voxtone::io
