// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places in boxes of cells, for the files of viewing_grid.h alone.
#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include "voxtone/optics/transport/coarse/viewing_grid.h"

namespace voxtone::optics {

using Place = std::array<std::int32_t, 3>;

inline std::size_t at3(const Place& i, const Place& n) {
    return (static_cast<std::size_t>(i[2]) * static_cast<std::size_t>(n[1]) + static_cast<std::size_t>(i[1])) *
               static_cast<std::size_t>(n[0]) +
           static_cast<std::size_t>(i[0]);
}
inline std::size_t product(const Place& n) {
    return static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]);
}
template <class Body>
void for_each(const Place& n, Body&& body) {
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) body(Place{x, y, z});
}
inline std::size_t place_in_block(int x, int y, int z) { return static_cast<std::size_t>((z * 4 + y) * 4 + x); }

inline int reflected(int i, int n) {
    while (i < 0 || i >= n) i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i;
}

/// A box of voxels; beyond mirrored sides those before them.
inline void read_box(const ResinVolume& volume, bool mirrored, const Place& corner, const Place& extent,
                     std::vector<Material>& out) {
    out.resize(product(extent));
    volume.copy_box(corner, extent, out);
    if (!mirrored) return;
    const auto& size = volume.size();
    if (corner[0] >= 0 && corner[1] >= 0 && corner[0] + extent[0] <= size[0] && corner[1] + extent[1] <= size[1])
        return;
    std::size_t i = 0;
    for_each(extent, [&](const Place& at) {
        const int x = corner[0] + at[0], y = corner[1] + at[1];
        if (x < 0 || y < 0 || x >= size[0] || y >= size[1])
            out[i] = volume.at(reflected(x, size[0]), reflected(y, size[1]), corner[2] + at[2]);
        ++i;
    });
}

template <class Body>
void ViewingGrid::each_face(std::uint32_t cell, Body&& body) const {
    const unsigned bits = grid.outer[cell];
    if (bits == 0 || bits & 64u) return;
    const GridBlock& home = grid.blocks[grid.transport_blocks[cell / 64]];
    const auto first =
        static_cast<std::uint32_t>(grid.face_of_cell[static_cast<std::size_t>(home.first_link) + cell % 64]);
    for (std::uint32_t f = first; f < first + static_cast<std::uint32_t>(std::popcount(bits)); ++f) body(f);
}

}  // namespace voxtone::optics
