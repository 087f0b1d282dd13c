// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/viewing_grid.h"

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

GridFrame::GridFrame(const Scene& scene, const Place& cell, const ViewingWindow& part)
    : view_voxels(cell),
      size(scene.volume->size()),
      pitch_mm(scene.volume->pitch_mm()),
      window(part),
      directions(make_directions(scene.resins->g, scene.resins->eta)),
      mirrored(scene.sides == Sides::mirrored),
      backing(scene.backing),
      sheet(scene.sheet),
      spread(scene.spread_mm, scene.volume->pitch_mm()),
      resins(scene.resins->resins.size()) {
    if (scene.resins->has_own_eta()) {
        std::vector<double> eta;
        for (const Resin& resin : scene.resins->resins) eta.push_back(scene.resins->eta_of(resin));
        const auto [least, most] = std::minmax_element(eta.begin(), eta.end());
        eta_range = {*least, *most};
        for (const double of : eta)
            eta_step.push_back(*most > *least ? static_cast<float>((of - *least) / (*most - *least) * (eta_steps - 1))
                                              : 0.0f);
    }
    const BlockLattice whole(size, cell);
    for (std::size_t a = 0; a < 3; ++a) {
        lattice[a] = window.end[a] - window.begin[a];
        shift_voxels[a] = whole.shift_voxels[a] - window.begin[a] * whole.block_voxels[a];
    }
}

Place GridFrame::corner(const Place& at, int cells) const {
    Place corner{};
    for (std::size_t a = 0; a < 3; ++a) corner[a] = at[a] * cells * view_voxels[a] - shift_voxels[a];
    return corner;
}

bool GridFrame::is_ghost(const Place& block) const {
    for (std::size_t a = 0; a < 3; ++a)
        if ((window.cut[2 * a] && block[a] == 0) || (window.cut[2 * a + 1] && block[a] == lattice[a] - 1)) return true;
    return false;
}

FaceKind GridFrame::kind_beyond(const Place& next, std::size_t f) const {
    const std::size_t a = f / 2;
    const int low = corner_of_cell(next)[a];
    if (is_mirrored(a) && (low + view_voxels[a] <= 0 || low >= size[a])) return FaceKind::mirror;
    if (f != 4 || low >= 0 || backing == Backing::none) return FaceKind::light;
    return backing == Backing::black ? FaceKind::black_sheet : FaceKind::white_sheet;
}

std::array<double, 3> GridFrame::edge_mm() const {
    return {view_voxels[0] * pitch_mm[0], view_voxels[1] * pitch_mm[1], view_voxels[2] * pitch_mm[2]};
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
        to = beside(at, f);
        const std::int64_t next = cell_of(to);
        if (next < 0) continue;
        const Place from = corner_of_cell(at);
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
    const Place block{at[0] >> 2, at[1] >> 2, at[2] >> 2};
    if (!lies_in(block, lattice)) return -1;
    const std::int32_t b = block_at[at3(block, lattice)];
    if (b < 0) return -1;
    const GridBlock& home = blocks[static_cast<std::size_t>(b)];
    if (home.kind == BlockKind::core) return -1;
    const std::size_t place = place_in_block({at[0] % 4, at[1] % 4, at[2] % 4});
    return home.solid >> place & 1 ? static_cast<std::int64_t>(home.first_cell + place) : -1;
}

}  // namespace voxtone::optics
