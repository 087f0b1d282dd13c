// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/support_contact.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace voxtone::slicer {

SupportContact::SupportContact(const optics::ResinVolume& volume, double glossy, double matt)
    : size_(volume.size()), pitch_mm_(volume.pitch_mm()), glossy_(glossy), matt_(matt) {
    const auto width = static_cast<std::size_t>(size_[0]);
    top_.assign(width * static_cast<std::size_t>(size_[1]), 0);
    parallel_for(0, static_cast<std::size_t>(size_[1]), 8, [&](std::size_t y) {
        // Boxes of one row, from above: most columns are found in the first ones that hold anything.
        constexpr int high = 16;
        std::vector<optics::Material> box(width * high);
        std::size_t found = 0;
        for (int end = size_[2]; end > 0 && found < width; end -= high) {
            const int first = std::max(0, end - high);
            const std::array<int, 3> corner{0, static_cast<int>(y), first}, extent{size_[0], 1, end - first};
            if (volume.uniform_material(corner, extent) == optics::air) continue;
            volume.copy_box(corner, extent, std::span(box).first(width * static_cast<std::size_t>(end - first)));
            for (std::size_t x = 0; x < width; ++x) {
                std::int32_t& top = top_[y * width + x];
                if (top != 0) continue;
                for (int z = end - first - 1; z >= 0 && top == 0; --z)
                    if (box[static_cast<std::size_t>(z) * width + x] != optics::air) top = first + z + 1;
                found += top != 0;
            }
        }
    });
}

bool SupportContact::touched(const optics::Point& at, const optics::Point& outward) const {
    // The voxel before the face: a voxel and a half away, past what the staircase may still hold of the body.
    std::array<int, 3> voxel{};
    for (std::size_t a = 0; a < 3; ++a)
        voxel[a] = static_cast<int>(std::floor(at[a] / pitch_mm_[a] + 1.5 * outward[a]));
    if (voxel[2] < 0) return true;  // the tray
    if (voxel[0] < 0 || voxel[0] >= size_[0] || voxel[1] < 0 || voxel[1] >= size_[1]) return false;
    const auto column =
        static_cast<std::size_t>(voxel[1]) * static_cast<std::size_t>(size_[0]) + static_cast<std::size_t>(voxel[0]);
    return voxel[2] < top_[column];
}

}  // namespace voxtone::slicer
