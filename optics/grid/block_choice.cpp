// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/block_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "optics/grid/sheet_way.h"

namespace voxtone::optics {
namespace {

class BlockChooser {
public:
    BlockChooser(const Scene& scene, const GridFrame& frame, const BlockContents& contents, const ColourDepth& colour,
                 const Progress* progress)
        : scene_(scene),
          frame_(frame),
          contents_(contents),
          colour_(colour),
          progress_(progress),
          wanted_(contents.size(), 0),
          seed_(contents.size(), 0) {
        for (std::size_t a = 0; a < 3; ++a) edge_[a] = frame.block_voxels()[a] * frame.pitch_mm[a];
    }

    [[nodiscard]] std::vector<std::uint8_t> run(std::span<const std::uint8_t> also, const Surface* requested) {
        want_below(want_surface(also, requested));
        check();
        if (colour_.deeper_in_nodes)
            for (std::size_t here = 0; here < seed_.size(); ++here)
                seed_[here] |= wanted_[here] && contents_[here].material < 0;
        want_margins();
        want_slivers();
        check();
        return std::move(wanted_);
    }

private:
    void check() const {
        if (progress_) progress_->check_cancelled();
    }
    /// body(place, its index).
    template <class Body>
    void each_block(Body&& body) const {
        std::size_t here = 0;
        for_each(frame_.lattice, [&](const Place& at) { body(at, here++); });
    }
    /// body(place, its index) of the 26 around that the lattice has, and of itself.
    template <class Body>
    void each_around(const Place& at, Body&& body) const {
        for_each({3, 3, 3}, [&](const Place& k) {
            const Place to{at[0] + k[0] - 1, at[1] + k[1] - 1, at[2] + k[2] - 1};
            if (lies_in(to, frame_.lattice)) body(to, at3(to, frame_.lattice), k);
        });
    }

    /// Blocks with a face of the surface, and those beside them; all where none was asked for.
    [[nodiscard]] std::vector<std::uint8_t> blocks_at(const Surface* surface) const {
        std::vector<std::uint8_t> marked(contents_.size(), surface ? 0 : 1);
        if (!surface) return marked;
        const auto mark = [&](const Place& at) {
            if (lies_in(at, frame_.lattice)) marked[at3(at, frame_.lattice)] = 1;
        };
        const Place block = frame_.block_voxels();
        for (const SurfaceFace& face : surface->faces) {
            Place voxel{};
            for (std::size_t a = 0; a < 3; ++a) voxel[a] = face.voxel[a] + frame_.shift_voxels[a];
            const Place at{voxel[0] / block[0], voxel[1] / block[1], voxel[2] / block[2]};
            if (std::ranges::min(voxel) < 0 || !lies_in(at, frame_.lattice)) continue;
            mark(at);
            for (std::size_t f = 0; f < 6; ++f) mark(beside(at, f));
        }
        return marked;
    }

    /// Wants those at the surface, on a sheet that light reaches and in `also`; seeds margins at those of several
    /// materials and those that are lit. The lit ones of what is `requested`.
    [[nodiscard]] std::vector<Place> want_surface(std::span<const std::uint8_t> also, const Surface* requested) {
        const std::vector<std::uint8_t> at_surface = blocks_at(requested);
        const std::vector<std::uint8_t> deep =
            scene_.backing == Backing::none ? std::vector<std::uint8_t>(contents_.size(), 0) : blocks_deep_on_sheet();
        std::vector<Place> surface;
        each_block([&](const Place& at, std::size_t here) {
            if (contents_[here].empty()) return;
            const bool seeds_margin = contents_[here].material < 0 && !colour_.deeper_in_nodes;
            if (frame_.is_ghost(at)) {
                seed_[here] = seeds_margin;
                return;
            }
            const auto [lit, sheet] = beyond(at);
            if (lit && at_surface[here]) surface.push_back(at);
            const bool seen_sheet = sheet && !deep[here];
            if (lit || seen_sheet || (!also.empty() && also[here])) wanted_[here] = 1;
            seed_[here] = lit || seeds_margin || (seen_sheet && colour_.deeper_in_nodes);
        });
        return surface;
    }

    /// Which blocks are so deep in one resin that a node of diffusion on a sheet serves as well as cells do
    /// (sheet_way.h). In grids that keep their shape colour is still to come.
    [[nodiscard]] std::vector<std::uint8_t> blocks_deep_on_sheet() const {
        const double edge = std::ranges::min(edge_), coloured = colour_.deeper_in_nodes ? colour_.mm : 0;
        std::vector<int> rings_of;
        for (const Resin& resin : scene_.resins->resins)
            rings_of.push_back(1 + static_cast<int>(std::ceil(
                                       (sheet_depth_mm(*scene_.resins, resin, frame_.directions) + coloured) / edge)));
        std::vector<std::uint8_t> deep(contents_.size(), 0);
        std::vector<int> ring(contents_.size(), -1);
        std::vector<Place> front, next_front;
        each_block([&](const Place& at, std::size_t here) {
            if (contents_[here].empty()) return;
            bool other = contents_[here].material < 0 || beyond(at).lit;
            for (std::size_t f = 0; f < 6; ++f)
                if (const Place next = beside(at, f); lies_in(next, frame_.lattice))
                    other |= !contents_[next].empty() && contents_[next].material != contents_[here].material;
            if (!other) return;
            ring[here] = 0;
            front.push_back(at);
        });
        for (int r = 1; !front.empty(); ++r) {
            next_front.clear();
            for (const Place& at : front)
                each_around(at, [&](const Place& next, std::size_t there, const Place&) {
                    if (ring[there] >= 0 || contents_[there].empty()) return;
                    ring[there] = r;
                    deep[there] = r >= rings_of[static_cast<std::size_t>(contents_[there].material) - 1];
                    next_front.push_back(next);
                });
            front.swap(next_front);
        }
        return deep;
    }

    /// Whether all cells of a block that lie at the far side of its neighbour's face f are solid.
    [[nodiscard]] bool covers(const Place& block, std::size_t f) const {
        if (contents_[block].empty()) return false;
        Place side{4, 4, 4}, first{4 * block[0], 4 * block[1], 4 * block[2]};
        side[f / 2] = 1;
        first[f / 2] += f % 2 == 1 ? 0 : 3;
        bool solid = true;
        for_each(side, [&](const Place& in) {
            solid = solid && contents_.is_solid({first[0] + in[0], first[1] + in[1], first[2] + in[2]});
        });
        return solid;
    }

    /// What a block that is not empty has around it.
    struct Beyond {
        bool lit = false, sheet = false;
    };
    [[nodiscard]] Beyond beyond(const Place& at) const {
        Beyond found{!contents_[at].closed, false};
        for (std::size_t f = 0; f < 6 && !found.lit; ++f) {
            const Place next = beside(at, f);
            const bool inside = lies_in(next, frame_.lattice), closed = inside && contents_[next].closed;
            // Beside a block that is full but for what reaches below the sheet there is no light.
            if (inside && (covers(next, f) || (f != 4 && closed))) continue;
            Place cell{4 * at[0], 4 * at[1], 4 * at[2]};
            if (f % 2 == 1) cell[f / 2] += 3;
            // A sliver on a sheet may leave no solid cell of its own.
            const FaceKind kind = inside && !closed ? FaceKind::light : frame_.kind_beyond(beside(cell, f), f);
            found.lit |= kind == FaceKind::light;
            found.sheet |= kind == FaceKind::black_sheet || kind == FaceKind::white_sheet;
        }
        found.sheet |= scene_.backing != Backing::none && frame_.corner_of(at)[2] <= 0;
        return found;
    }

    /// Wants the blocks near the surface: by the distance from the middle of a surface block to the near side of the
    /// block.
    void want_below(const std::vector<Place>& surface) {
        std::vector<Place> near;
        Place reach{};
        for (std::size_t a = 0; a < 3; ++a) reach[a] = static_cast<int>(std::ceil(colour_.mm / edge_[a]));
        for_each({2 * reach[0] + 1, 2 * reach[1] + 1, 2 * reach[2] + 1}, [&](const Place& k) {
            const Place step{k[0] - reach[0], k[1] - reach[1], k[2] - reach[2]};
            double d2 = 0;
            for (std::size_t a = 0; a < 3; ++a) d2 += std::pow(std::max(std::abs(step[a]) - 0.5, 0.0) * edge_[a], 2);
            if (d2 < colour_.mm * colour_.mm) near.push_back(step);
        });
        for (const Place& at : surface) {
            check();
            for (const Place& k : near)
                if (const Place to{at[0] + k[0], at[1] + k[1], at[2] + k[2]}; lies_in(to, frame_.lattice))
                    wanted_[at3(to, frame_.lattice)] = 1;
        }
    }

    /// Wants the seeds and the rings around them in which light becomes diffuse.
    void want_margins() {
        int rings = 0;
        std::vector<std::uint8_t> known(seed_.size(), 0);
        std::vector<Place> front, next_front;
        each_block([&](const Place& at, std::size_t here) {
            rings = std::max<int>(rings, contents_[here].rings);
            if (!seed_[here]) return;
            known[here] = wanted_[here] = 1;
            front.push_back(at);
        });
        for (int r = 1; r <= rings; ++r) {
            next_front.clear();
            for (const Place& at : front)
                each_around(at, [&](const Place& to, std::size_t there, const Place& k) {
                    if (k[0] != 1 && k[1] != 1 && k[2] != 1) return;  // across a face or an edge
                    if (known[there] || contents_[there].empty()) return;
                    known[there] = 1;
                    if (r <= contents_[there].rings) wanted_[there] = 1;
                    next_front.push_back(to);
                });
            front.swap(next_front);
        }
    }

    /// On a sheet a block may have no solid cell of its own: what it holds are cells of the one above, or its node's.
    void want_slivers() {
        if (!frame_.is_on_sheet({0, 0, 0}) || frame_.lattice[2] < 2) return;
        const std::size_t plane = product({frame_.lattice[0], frame_.lattice[1], 1});
        for (std::size_t here = 0; here < plane; ++here)
            if (!contents_[here].empty() && wanted_[here + plane]) wanted_[here] = 1;
    }

    const Scene& scene_;
    const GridFrame& frame_;
    const BlockContents& contents_;
    const ColourDepth& colour_;
    const Progress* progress_;
    std::array<double, 3> edge_{};             ///< of a block, mm
    std::vector<std::uint8_t> wanted_, seed_;  ///< of each place: has cells; a margin grows from it
};

}  // namespace

std::vector<std::uint8_t> blocks_with_cells(const Scene& scene, const GridFrame& frame, const BlockContents& contents,
                                            const ColourDepth& colour, std::span<const std::uint8_t> also,
                                            const Surface* requested, const Progress* progress) {
    return BlockChooser(scene, frame, contents, colour, progress).run(also, requested);
}

}  // namespace voxtone::optics
