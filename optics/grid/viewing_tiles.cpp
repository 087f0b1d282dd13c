// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/viewing_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

struct Cut {
    const BlockLattice& lattice;
    const std::array<double, 3>& pitch_mm;
    const std::vector<Place>& block_of;  // of each surface cell
    std::size_t most_cells;
    int halo;
    std::vector<ViewingTile>& out;

    void halve(ViewingTile tile) {
        if (tile.cells.size() <= most_cells || !split(tile)) finish(std::move(tile));
    }

    /// False where a tile is too small to be cut.
    bool split(ViewingTile& tile) {
        std::array<std::size_t, 3> axes{0, 1, 2};
        const auto edge_mm = [&](std::size_t a) {
            return (tile.end[a] - tile.begin[a]) * lattice.block_voxels[a] * pitch_mm[a];
        };
        std::stable_sort(axes.begin(), axes.end(),
                         [&](std::size_t a, std::size_t b) { return edge_mm(a) > edge_mm(b); });
        const int least = 2 * (halo + 1);  // a tile thinner than its halos would not be worth its while
        for (const std::size_t axis : axes) {
            if (tile.end[axis] - tile.begin[axis] < 2 * least) continue;
            std::vector<std::int32_t> places;
            for (const std::uint32_t cell : tile.cells) places.push_back(block_of[cell][axis]);
            const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
            std::nth_element(places.begin(), middle, places.end());
            const int at = std::clamp(*middle, tile.begin[axis] + least, tile.end[axis] - least);
            ViewingTile upper;
            upper.begin = tile.begin;
            upper.end = tile.end;
            const auto first = std::stable_partition(tile.cells.begin(), tile.cells.end(),
                                                     [&](std::uint32_t cell) { return block_of[cell][axis] < at; });
            if (first == tile.cells.begin() || first == tile.cells.end())
                continue;  // each tile has something that is seen
            upper.cells.assign(first, tile.cells.end());
            tile.cells.erase(first, tile.cells.end());
            tile.end[axis] = upper.begin[axis] = at;
            halve(std::move(tile));
            halve(std::move(upper));
            return true;
        }
        return false;
    }

    void finish(ViewingTile tile) {
        for (std::size_t a = 0; a < 3; ++a) {
            const int reach = halo + 1;
            tile.window.cut[2 * a] = tile.begin[a] > reach;
            tile.window.cut[2 * a + 1] = tile.end[a] + reach < lattice.blocks[a];
            tile.window.begin[a] = std::max(tile.begin[a] - reach, 0);
            tile.window.end[a] = std::min(tile.end[a] + reach, lattice.blocks[a]);
            tile.voxels.begin[a] = tile.begin[a] * lattice.block_voxels[a] - lattice.shift_voxels[a];
            tile.voxels.end[a] = tile.end[a] * lattice.block_voxels[a] - lattice.shift_voxels[a];
        }
        for (std::uint32_t i = 0; i < block_of.size(); ++i) {
            bool inside = true;
            for (std::size_t a = 0; a < 3; ++a)
                inside &= block_of[i][a] >= tile.window.begin[a] + tile.window.cut[2 * a] &&
                          block_of[i][a] < tile.window.end[a] - tile.window.cut[2 * a + 1];
            if (inside) tile.near.push_back(i);
        }
        out.push_back(std::move(tile));
    }
};

}  // namespace

std::vector<ViewingTile> viewing_tiles(const Surface& surface, const std::array<int, 3>& size,
                                       const std::array<double, 3>& pitch_mm, const std::array<int, 3>& view_voxels,
                                       std::size_t most_cells, int halo) {
    VOXTONE_EXPECT(most_cells >= 1 && halo >= 1);
    const BlockLattice lattice(size, view_voxels);
    std::vector<Place> block_of(surface.cells.size());
    for (std::size_t i = 0; i < block_of.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            // Of the voxel below the middle of the cell's faces.
            const double at = static_cast<double>(surface.cells[i].centre_mm[a]) / pitch_mm[a] -
                              1e-3 * static_cast<double>(surface.cells[i].normal[a]);
            block_of[i][a] =
                std::clamp((static_cast<int>(std::floor(at)) + lattice.shift_voxels[a]) / lattice.block_voxels[a], 0,
                           lattice.blocks[a] - 1);
        }
    std::vector<ViewingTile> tiles;
    ViewingTile whole;
    whole.end = lattice.blocks;
    whole.cells.resize(surface.cells.size());
    std::iota(whole.cells.begin(), whole.cells.end(), 0u);
    Cut{lattice, pitch_mm, block_of, most_cells, halo, tiles}.halve(std::move(whole));
    return tiles;
}

}  // namespace voxtone::optics
