// SPDX-License-Identifier: GPL-3.0-or-later
//
// A photograph's file to its samples, in this process (io/pictures/photograph.h reads in another one).
#pragma once

#include <filesystem>

#include "io/pictures/photograph.h"

namespace voxtone::io {

/// Throws InputError saying what is wrong with the file.
[[nodiscard]] Photograph decode_photograph(const std::filesystem::path& file, bool by_profile = false);

}  // namespace voxtone::io
