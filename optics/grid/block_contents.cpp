// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/block_contents.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "optics/media/mirrored_box.h"

namespace voxtone::optics {
namespace {

/// Rings of blocks of this resin below those that are lit in which light becomes diffuse: in each channel 2.3 transport
/// mean free paths, and one ring less where hardly anything is absorbed: there diffusion is right half as deep. A block
/// of several resins takes those of its clearest, whatever else the set has. Slabs of one resin, wherever they cut the
/// blocks, are within 0.001 of the exact solution; with one ring for all, magenta and yellow are 0.005 off
/// (viewing_sequence_test, "margins suffice").
std::uint8_t diffuse_rings(const ResinSet& set, const Resin& resin, double block_mm) {
    constexpr double free_paths = 2.3, hardly = 0.01;
    int rings = 1;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const Medium medium = resin.medium(c);
        const double sigma = medium.sigma_a + (1 - set.g) * medium.sigma_s;
        const int spared = 1 - medium.albedo() < hardly ? 1 : 0;
        rings = std::max(rings,
                         static_cast<int>(std::ceil(free_paths / (std::max(sigma, 1e-3) * block_mm) - 0.1)) - spared);
    }
    return static_cast<std::uint8_t>(std::min(rings, 12));
}

}  // namespace

/// Reads one block after the other.
class BlockContents::Reader {
public:
    Reader(const Scene& scene, const GridFrame& frame) : scene_(scene), frame_(frame) {
        double edge = 0;
        for (std::size_t a = 0; a < 3; ++a) edge = std::max(edge, frame.block_voxels()[a] * frame.pitch_mm[a]);
        for (std::size_t m = 1; m <= frame.resins; ++m)
            rings_of_[m] = diffuse_rings(*scene.resins, scene.resins->resins[m - 1], edge);
    }

    /// Fills of a block that is neither full nor empty go to the end of `fills`.
    [[nodiscard]] Block read(const Place& at, std::vector<std::uint8_t>& fills) {
        const Place corner = frame_.corner_of(at), extent = frame_.block_voxels(), &view = frame_.view_voxels;
        const int only = scene_.volume->uniform_material(corner, extent);
        if (only >= 0)
            return {static_cast<std::int16_t>(only), only != air, only != air,
                    rings_of_[static_cast<std::size_t>(only)], 0};
        read_box(*scene_.volume, frame_.mirrored, corner, extent, box_);
        Block block;
        std::array<std::uint8_t, 64> fill{};
        bool any_air = false, open = false;
        for_each({4, 4, 4}, [&](const Place& cell) {
            const Place first{cell[0] * view[0], cell[1] * view[1], cell[2] * view[2]};
            for (std::size_t a = 0; a < 2; ++a)  // beyond a mirror there is nothing
                if (frame_.is_mirrored(a) && corner[a] + first[a] >= frame_.size[a]) {
                    any_air = open = true;
                    return;
                }
            for_each(view, [&](const Place& in) {
                const Material m = box_[at3({first[0] + in[0], first[1] + in[1], first[2] + in[2]}, extent)];
                if (m == air) {
                    any_air = true;
                    open |= frame_.backing == Backing::none || corner[2] + first[2] + in[2] >= 0;
                    return;
                }
                ++fill[place_in_block(cell)];
                block.rings = std::max(block.rings, rings_of_[m]);
                block.material = block.material == 0 || block.material == m ? m : std::int16_t{-1};
            });
        });
        if (block.empty()) return {};
        block.full = !any_air;
        block.closed = !open;
        if (any_air) {
            block.first_fill = static_cast<std::uint32_t>(fills.size());
            fills.insert(fills.end(), fill.begin(), fill.end());
        }
        return block;
    }

private:
    const Scene& scene_;
    const GridFrame& frame_;
    std::array<std::uint8_t, 256> rings_of_{};  ///< of each material
    std::vector<Material> box_;
};

BlockContents::BlockContents(const Scene& scene, const GridFrame& frame, const Progress* progress)
    : frame_(frame), in_cell_(static_cast<int>(product(frame.view_voxels))), blocks_(product(frame.lattice)) {
    const auto along = static_cast<std::size_t>(frame.lattice[0]);
    std::vector<std::vector<std::uint8_t>> fills_of_row(blocks_.size() / along);
    const auto read_rows = [&](std::size_t begin, std::size_t end) {
        Reader reader(scene, frame);
        for (std::size_t row = begin; row < end; ++row)
            for (std::size_t x = 0; x < along; ++x) {
                const Place at{static_cast<int>(x), static_cast<int>(row) % frame.lattice[1],
                               static_cast<int>(row) / frame.lattice[1]};
                blocks_[row * along + x] = reader.read(at, fills_of_row[row]);
            }
    };
    parallel_ranges(0, fills_of_row.size(), 4, read_rows, progress);
    for (std::size_t row = 0; row < fills_of_row.size(); ++row) {
        for (std::size_t x = 0; x < along; ++x)
            blocks_[row * along + x].first_fill += static_cast<std::uint32_t>(fills_.size());
        fills_.insert(fills_.end(), fills_of_row[row].begin(), fills_of_row[row].end());
    }
}

int BlockContents::fill_of(const Place& cell) const {
    const Place block{cell[0] >> 2, cell[1] >> 2, cell[2] >> 2};
    if (!lies_in(block, frame_.lattice)) return 0;
    const Block& holds = (*this)[block];
    if (holds.full || holds.empty()) return holds.full ? in_cell_ : 0;
    return fills_[holds.first_fill + place_in_block({cell[0] & 3, cell[1] & 3, cell[2] & 3})];
}

bool BlockContents::is_solid(const Place& cell) const {
    const int fill = fill_of(cell);
    if (fill == 0 || 2 * fill >= in_cell_) return fill > 0;
    for (std::size_t f = 0; f < 6; ++f)
        if (2 * fill_of(beside(cell, f)) >= in_cell_) return false;
    return true;
}

Place BlockContents::receiver(const Place& cell) const {
    Place best{};
    int most = 0;
    for (std::size_t f = 0; f < 6; ++f)
        if (const int fill = fill_of(beside(cell, f)); fill > most) {
            most = fill;
            best = beside(cell, f);
        }
    return best;
}

}  // namespace voxtone::optics
