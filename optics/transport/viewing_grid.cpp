// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_grid.h"

#include <algorithm>

#include "optics/media/mirrored_box.h"

namespace voxtone::optics {

BlockLattice::BlockLattice(const std::array<int, 3>& size, const std::array<int, 3>& view_voxels) {
    for (std::size_t a = 0; a < 3; ++a) {
        block_voxels[a] = 4 * view_voxels[a];
        blocks[a] = (size[a] + block_voxels[a] - 1) / block_voxels[a];
    }
    shift_voxels[2] = blocks[2] * block_voxels[2] - size[2];
}

Place ViewingGrid::corner_of(const Place& block) const {
    Place corner{};
    for (std::size_t a = 0; a < 3; ++a) corner[a] = block[a] * 4 * view_voxels[a] - shift_voxels[a];
    return corner;
}

void ViewingGrid::shrink() {
    each_list(*this, [](auto& list) { list.shrink_to_fit(); });
}

ViewingGrid::Content ViewingGrid::content_of(const GridBlock& block, const ResinVolume& volume,
                                             std::vector<Material>& box) const {
    const Place corner = corner_of(block.at), extent = block_voxels();
    if (const int whole = volume.uniform_material(corner, extent); whole >= 0)
        return {static_cast<std::int16_t>(whole), whole == air};
    read_box(volume, mirrored, corner, extent, box);
    Content found;
    for (const Material m : box) {
        if (m == air)
            found.any_air = true;
        else
            found.resin = found.resin == 0 || found.resin == m ? m : std::int16_t{-1};
    }
    return found;
}

ViewingGrid::Home ViewingGrid::home_of(const Place& voxel) const {
    const Place& view = view_voxels;
    Place at{}, in{};
    Home home;
    home.share = 1 / static_cast<float>(view[0] * view[1] * view[2]);
    for (std::size_t a = 0; a < 3; ++a) {
        const int v = voxel[a] + shift_voxels[a];
        if (v < 0 || v >= 4 * lattice[a] * view[a]) return {};
        at[a] = v / view[a];
        in[a] = v % view[a];
        // A cell that sticks out of a mirrored side holds the image too.
        if (mirrored && a < 2 && 2 * size[a] - 1 - voxel[a] < (at[a] + 1) * view[a] - shift_voxels[a]) home.share *= 2;
    }
    Place to = at;
    home.cell = cell_of(to);
    for (std::size_t f = 0; f < 6 && home.cell < 0; ++f) {
        to = {at[0] + step_of[f][0], at[1] + step_of[f][1], at[2] + step_of[f][2]};
        const std::int64_t next = cell_of(to);
        if (next < 0) continue;
        Place from{};
        for (std::size_t a = 0; a < 3; ++a) from[a] = at[a] * view[a] - shift_voxels[a];
        for (const Donor& donor : donors_to(static_cast<std::uint32_t>(next)))
            if (donor.from == from) home.cell = next;
    }
    if (home.cell < 0) return {};
    const std::uint8_t facing = towards[static_cast<std::size_t>(home.cell / 64)];
    home.axis = facing / 2;
    const int layers = view[home.axis],
              layer = std::clamp((at[home.axis] - to[home.axis]) * layers + in[home.axis], 0, layers - 1);
    home.layer = static_cast<std::uint8_t>(facing % 2 == 1 ? layers - 1 - layer : layer);
    return home;
}

std::span<const ViewingGrid::Donor> ViewingGrid::donors_to(std::uint32_t cell) const {
    const std::size_t t = cell / 64;
    const auto of_block = std::span(donors).subspan(donors_of[t], donors_of[t + 1] - donors_of[t]);
    const auto found = std::ranges::equal_range(of_block, cell, {}, &Donor::to);
    return {found.begin(), found.end()};
}

std::size_t ViewingGrid::memory_bytes() const {
    std::size_t bytes = 0;
    each_list(*this, [&](const auto& list) { bytes += list.capacity() * sizeof(list[0]); });
    return bytes;
}

std::int64_t ViewingGrid::cell_of(const Place& at) const {
    Place block{};
    for (std::size_t a = 0; a < 3; ++a) {
        if (at[a] < 0 || at[a] >= 4 * lattice[a]) return -1;
        block[a] = at[a] / 4;
    }
    const std::int32_t b = block_at[at3(block, lattice)];
    if (b < 0) return -1;
    const GridBlock& home = blocks[static_cast<std::size_t>(b)];
    if (home.kind == BlockKind::core) return -1;
    const std::size_t place = place_in_block({at[0] % 4, at[1] % 4, at[2] % 4});
    return home.solid >> place & 1 ? static_cast<std::int64_t>(home.first_cell + place) : -1;
}

}  // namespace voxtone::optics
