// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/mirrored_box.h"

#include <cstddef>

namespace voxtone::optics {

void read_box(const ResinVolume& volume, bool mirrored, const std::array<int, 3>& corner,
              const std::array<int, 3>& extent, std::vector<Material>& out) {
    out.resize(static_cast<std::size_t>(extent[0]) * static_cast<std::size_t>(extent[1]) *
               static_cast<std::size_t>(extent[2]));
    volume.copy_box(corner, extent, out);
    if (!mirrored) return;
    const auto& size = volume.size();
    const std::array<int, 3> end{corner[0] + extent[0], corner[1] + extent[1], corner[2] + extent[2]};
    if (corner[0] >= 0 && corner[1] >= 0 && end[0] <= size[0] && end[1] <= size[1]) return;
    std::size_t i = 0;
    for (int z = corner[2]; z < end[2]; ++z)
        for (int y = corner[1]; y < end[1]; ++y)
            for (int x = corner[0]; x < end[0]; ++x, ++i)
                if (x < 0 || y < 0 || x >= size[0] || y >= size[1])
                    out[i] = volume.at(reflected(x, size[0]), reflected(y, size[1]), z);
}

}  // namespace voxtone::optics
