// SPDX-License-Identifier: GPL-3.0-or-later
//
// volume_vdb.h by OpenVDB: the source of the module voxtone-vdb.so.
#pragma once

#include <filesystem>

#include "base/progress.h"
#include "io/layers/manifest.h"

namespace voxtone::io {

void write_resin_grids(const std::filesystem::path& file, const std::filesystem::path& numbers,
                       const StackDescription& stack, const std::filesystem::path& folder, Progress* progress);

}  // namespace voxtone::io

/// The module's door.
extern "C" void voxtone_write_resin_grids(const std::filesystem::path& file, const std::filesystem::path& numbers,
                                          const voxtone::io::StackDescription& stack,
                                          const std::filesystem::path& folder, voxtone::Progress* progress);
