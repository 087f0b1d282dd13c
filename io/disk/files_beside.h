// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which files beside a model its reader may open: textures, libraries of materials, buffers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::io {

/// How far a reader may see: below that nobody keeps a model's textures, and a home folder has no end.
struct FilesBesideLimits {
    std::size_t depth = 3;  ///< folders below the model's
    std::size_t files = 4096;
};

/// Files in `folder` (empty: the current one) and below it, those of upper folders first, by name. Without what begins
/// with a dot, which is nobody's texture and may be a key, in any folder; a link counts as the file that it leads to,
/// where that one lies below `folder`, and leads nowhere else. Whoever may open these may open no other file, even
/// if it lays a link among them. What cannot be listed is left out.
[[nodiscard]] std::vector<std::string> files_beside(const std::filesystem::path& folder,
                                                    const FilesBesideLimits& limits = {});

}  // namespace voxtone::io
