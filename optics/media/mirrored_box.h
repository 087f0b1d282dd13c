// SPDX-License-Identifier: GPL-3.0-or-later
//
// Voxels of a volume whose sides may be mirrors: beyond them the volume goes on as its own image.
#pragma once

#include <array>
#include <vector>

#include "optics/media/resin_volume.h"

namespace voxtone::optics {

/// Index i, any, as mirrors at both ends of 0 .. n - 1 show it.
[[nodiscard]] inline int reflected(int i, int n) {
    while (i < 0 || i >= n) i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i;
}

/// The voxels of the box corner .. corner + extent, x fastest; beyond the volume air, but images beyond the four sides
/// where they are mirrored.
void read_box(const ResinVolume& volume, bool mirrored, const std::array<int, 3>& corner,
              const std::array<int, 3>& extent, std::vector<Material>& out);

}  // namespace voxtone::optics
