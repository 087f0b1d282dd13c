// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places in boxes: of voxels, of cells, of blocks of 4 x 4 x 4 cells. x runs fastest, then y, then z.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace voxtone::optics {

using Place = std::array<std::int32_t, 3>;

/// Index of a place in a box of n.
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
/// Whether a box of n has this place.
inline bool lies_in(const Place& i, const Place& n) {
    return i[0] >= 0 && i[1] >= 0 && i[2] >= 0 && i[0] < n[0] && i[1] < n[1] && i[2] < n[2];
}
/// Index of a cell in its block.
inline std::size_t place_in_block(const Place& at) { return static_cast<std::size_t>((at[2] * 4 + at[1]) * 4 + at[0]); }

}  // namespace voxtone::optics
