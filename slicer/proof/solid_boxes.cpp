// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/solid_boxes.h"

#include <algorithm>

namespace voxtone::slicer {

std::vector<Box> solid_boxes(const optics::ResinVolume& volume) {
    const auto& size = volume.size();
    const auto& pitch = volume.pitch_mm();
    // What one row of the bottom and one column at each place of it say; then every voxel has to agree.
    std::vector<int> height(static_cast<std::size_t>(size[0]));
    std::vector<Box> boxes;
    for (int x = 0; x < size[0]; ++x) {
        int& h = height[static_cast<std::size_t>(x)];
        while (h < size[2] && volume.at(x, 0, h) != 0) ++h;
        const int before = x > 0 ? height[static_cast<std::size_t>(x) - 1] : 0;
        if (before != 0 && h != 0 && h != before) return {};
        if (h == 0) continue;
        if (before == 0) boxes.push_back({{x * pitch[0], 0, 0}, {0, size[1] * pitch[1], h * pitch[2]}});
        boxes.back().high.x() = (x + 1) * pitch[0];
    }
    std::vector<optics::Material> row(static_cast<std::size_t>(size[0]));
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y) {
            volume.copy_box({0, y, z}, {size[0], 1, 1}, row);
            for (std::size_t x = 0; x < row.size(); ++x)
                if ((row[x] != 0) != (z < height[x])) return {};
        }
    return boxes;
}

}  // namespace voxtone::slicer
