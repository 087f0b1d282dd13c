// SPDX-License-Identifier: GPL-3.0-or-later
//
// Copies that touch, overlap or lie so near that light passes from one to another: they become one body, whose
// appearance loop and prediction see the voxels of all, and whose surface ends where one of them is in another. Copies
// that are further from all others stay by themselves, looped and predicted once for all places.
#pragma once

#include <filesystem>
#include <vector>

#include "slicer/plate/tray_parts.h"

namespace voxtone::slicer {

/// Copies with less between them are one body. Set, not measured: where voxels touch, light passes for millimetres
/// (docs/decisions/015); across air there is no distance at which it ends, only less of it.
inline constexpr double near_mm = 2;

/// Appends a part for each kind of neighbourhood (the same bodies in the same places beside each other are one kind),
/// which keeps what it comes to in OUT/parts/A+B, and takes its copies off `alone` of the others. Pictures, parts that
/// cut and parts whose options differ but for model and placement stay as they are, with a warning. Throws what the
/// jobs of the parts throw.
void join_near_parts(std::vector<ReadyPart>& parts, const std::filesystem::path& out, Progress& progress);

}  // namespace voxtone::slicer
