// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace voxtone::slicer {

/// Where a copy of a part stands.
struct PlacedCopy {
    std::array<int, 3> at{};  ///< voxels from the print's corner
    int tray = 0;             ///< of those that are filled
};

}  // namespace voxtone::slicer
