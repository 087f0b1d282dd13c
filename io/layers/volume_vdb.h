// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stack as sparse OpenVDB volumes. For other programs a file of floating-point grids (16 bits), which are all that
// Blender and Python's openvdb take: "density", 1 in the body, and one for each resin by its role, 1 where it is; 0 is
// background and inactive. A file of its own, which those do not open, has one grid "resin" of int32: resin r of the
// list is r + 1, 0 is background and inactive. Voxel (i, j, k) is at origin_mm + pitch (i + 1/2, j + 1/2, k + 1/2) in
// the model's frame (what the orientation did to the bitmaps is undone): i along +x, j along +y, k along +z. Uniform
// blocks of 8^3 are tiles, so memory grows with the surface. The bitmaps are read back for it: layers are made in any
// order, and a block is seen only with all eight of its layers, which the writer does not keep. Not reproducible to the
// byte: OpenVDB puts a random id into the file's head.
#pragma once

#include <filesystem>

#include "base/progress.h"
#include "io/layers/manifest.h"

namespace voxtone::io {

/// Reads the layers under `folder` and writes both files. Throws FileError, InputError, Cancelled.
void write_volume_vdb(const std::filesystem::path& file, const std::filesystem::path& numbers,
                      const StackDescription& stack, const std::filesystem::path& folder, Progress* progress = nullptr);

}  // namespace voxtone::io
