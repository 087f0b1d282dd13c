// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_grid_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/media/mirrored_box.h"
#include "optics/transport/lattice.h"
#include "optics/transport/transport_medium.h"
#include "optics/transport/viewing_faces.h"
#include "optics/transport/viewing_palette.h"

namespace voxtone::optics {
namespace {

struct ViewingGridBuilder {
    ViewingGrid& grid;
    const Scene& scene;
    const Progress* progress;
    Place block_voxels{}, view{}, cells{};  // cells: of the lattice
    int in_cell = 1;
    enum : std::uint8_t { empty, full, part };
    std::vector<std::uint8_t> state{};          // of each place
    std::vector<std::int16_t> material{};       // of each place: the only one besides air, -1: several
    std::array<std::uint8_t, 256> margin_of{};  // of each material
    std::vector<std::uint8_t> margin{};         // of each place: the most of what it holds
    std::vector<std::uint8_t> closed{};    // of each place: full, but for what sticks out of the volume into a sheet
    std::vector<std::uint32_t> fill_of{};  // of each place that is `part`: first of its 64 in `fills`
    std::vector<std::uint8_t> fills{};
    std::vector<std::uint8_t> wanted{}, seed{};  // of each place: gets transport cells; a margin grows from it

    [[nodiscard]] bool mirrored(std::size_t axis) const { return grid.mirrored && axis < 2; }
    void check() const {
        if (progress) progress->check_cancelled();
    }

    void survey_volume() {
        view = grid.view_voxels;
        const BlockLattice whole(scene.volume->size(), view);
        block_voxels = whole.block_voxels;
        for (std::size_t a = 0; a < 3; ++a) {
            grid.lattice[a] = grid.window.end[a] - grid.window.begin[a];
            grid.shift_voxels[a] = whole.shift_voxels[a] - grid.window.begin[a] * block_voxels[a];
            cells[a] = 4 * grid.lattice[a];
        }
        in_cell = view[0] * view[1] * view[2];
        const std::size_t n = product(grid.lattice);
        state.assign(n, empty);
        material.assign(n, 0);
        margin.assign(n, 0);
        for (std::size_t m = 1; m <= scene.resins->resins.size(); ++m)
            margin_of[m] = static_cast<std::uint8_t>(margin_blocks(m));
        closed.assign(n, 0);
        fill_of.assign(n, 0);
        const auto places = static_cast<std::size_t>(grid.lattice[0]);
        const std::size_t rows = n / places;
        std::vector<std::vector<std::uint8_t>> row_fills(rows);
        const auto look_along = [&](std::size_t first, std::size_t last) {
            std::vector<Material> box;
            for (std::size_t row = first; row < last; ++row)
                for (std::size_t x = 0; x < places; ++x) look_at(row, x, row_fills[row], box);
        };
        parallel_ranges(0, rows, 4, look_along, progress);
        for (std::size_t row = 0; row < rows; ++row) {
            for (std::size_t x = 0; x < places; ++x)
                fill_of[row * places + x] += static_cast<std::uint32_t>(fills.size());
            fills.insert(fills.end(), row_fills[row].begin(), row_fills[row].end());
        }
    }

    void look_at(std::size_t row, std::size_t x, std::vector<std::uint8_t>& to, std::vector<Material>& box) {
        const Place block{static_cast<int>(x), static_cast<int>(row % static_cast<std::size_t>(grid.lattice[1])),
                          static_cast<int>(row / static_cast<std::size_t>(grid.lattice[1]))};
        const std::size_t here = at3(block, grid.lattice);
        const Place corner = grid.corner_of(block);
        const int only = scene.volume->uniform_material(corner, block_voxels);
        if (only >= 0) {
            state[here] = only == air ? empty : full;
            closed[here] = only != air;
            material[here] = static_cast<std::int16_t>(only);
            margin[here] = margin_of[static_cast<std::size_t>(only)];
            return;
        }
        read_box(*scene.volume, grid.mirrored, corner, block_voxels, box);
        std::array<std::uint8_t, 64> fill{};
        std::int16_t found = 0;
        bool any_air = false, open = false;
        for_each({4, 4, 4}, [&](const Place& at) {
            std::uint8_t& sum = fill[place_in_block(at)];
            for (std::size_t a = 0; a < 2; ++a)  // beyond a mirror there is nothing
                if (mirrored(a) && corner[a] + at[a] * view[a] >= scene.volume->size()[a]) {
                    any_air = open = true;
                    return;
                }
            for_each(view, [&](const Place& in) {
                const Material m =
                    box[at3({at[0] * view[0] + in[0], at[1] * view[1] + in[1], at[2] * view[2] + in[2]}, block_voxels)];
                if (m == air) {
                    any_air = true;
                    open |= scene.backing == Backing::none || corner[2] + at[2] * view[2] + in[2] >= 0;
                    return;
                }
                ++sum;
                margin[here] = std::max(margin[here], margin_of[m]);
                found = found == 0 || found == m ? m : std::int16_t{-1};
            });
        });
        if (found == 0) return;
        state[here] = any_air ? part : full;
        material[here] = found;
        closed[here] = !open;
        if (!any_air) return;
        fill_of[here] = static_cast<std::uint32_t>(to.size());
        to.insert(to.end(), fill.begin(), fill.end());
    }

    [[nodiscard]] Material some_material(const Place& block) const {
        std::vector<Material> box;
        read_box(*scene.volume, grid.mirrored, grid.corner_of(block), block_voxels, box);
        return *std::max_element(box.begin(), box.end());
    }

    [[nodiscard]] int fill_at(const Place& cell) const {
        Place block{}, in{};
        for (std::size_t a = 0; a < 3; ++a) {
            if (cell[a] < 0 || cell[a] >= cells[a]) return 0;
            block[a] = cell[a] / 4;
            in[a] = cell[a] % 4;
        }
        const std::size_t here = at3(block, grid.lattice);
        return state[here] == full ? in_cell : state[here] == empty ? 0 : fills[fill_of[here] + place_in_block(in)];
    }
    [[nodiscard]] static Place beside(const Place& cell, std::size_t f) {
        return {cell[0] + step_of[f][0], cell[1] + step_of[f][1], cell[2] + step_of[f][2]};
    }
    [[nodiscard]] bool solid_at(const Place& cell) const {
        const int fill = fill_at(cell);
        if (fill == 0 || 2 * fill >= in_cell) return fill > 0;
        for (std::size_t f = 0; f < 6; ++f)
            if (2 * fill_at(beside(cell, f)) >= in_cell) return false;
        return true;
    }
    /// Which neighbour a cell that is not solid gives its resin to.
    [[nodiscard]] Place receiver(const Place& cell) const {
        Place best{};
        int most = 0;
        for (std::size_t f = 0; f < 6; ++f) {
            const int fill = fill_at(beside(cell, f));
            if (fill > most) {
                most = fill;
                best = beside(cell, f);
            }
        }
        return best;
    }
    /// What lies beyond a face of a solid cell whose neighbour is not solid.
    [[nodiscard]] FaceKind kind_of(const Place& next, std::size_t f) const {
        const std::size_t a = f / 2;
        const int low = next[a] * view[a] - grid.shift_voxels[a];
        if (mirrored(a) && (low + view[a] <= 0 || low >= scene.volume->size()[a])) return FaceKind::mirror;
        if (f == 4 && low < 0 && scene.backing == Backing::black) return FaceKind::black_sheet;
        if (f == 4 && low < 0 && (scene.backing == Backing::white || scene.backing == Backing::sheet))
            return FaceKind::white_sheet;
        return FaceKind::light;
    }

    /// Rings of blocks of this resin below those that are lit in which light becomes diffuse: in each channel 2.3
    /// transport mean free paths, and one ring less where hardly anything is absorbed: there diffusion is right half as
    /// deep. A block of several resins takes those of its clearest, whatever else the set has. Slabs of one resin,
    /// wherever they cut the blocks, are within 0.001 of the exact solution; with one ring for all, magenta and yellow
    /// are 0.005 off (viewing_sequence_test, "margins suffice").
    [[nodiscard]] int margin_blocks(std::size_t m) const {
        constexpr double free_paths = 2.3, hardly = 0.01;
        double edge = 0;
        for (std::size_t a = 0; a < 3; ++a) edge = std::max(edge, block_voxels[a] * grid.pitch_mm[a]);
        int rings = 1;
        for (std::size_t c = 0; c < scene.resins->channels.size(); ++c) {
            const Medium medium = scene.resins->resins[m - 1].medium(c);
            const double sigma = medium.sigma_a + (1 - scene.resins->g) * medium.sigma_s;
            const int spared = 1 - medium.albedo() < hardly ? 1 : 0;
            rings = std::max(rings,
                             static_cast<int>(std::ceil(free_paths / (std::max(sigma, 1e-3) * edge) - 0.1)) - spared);
        }
        return std::min(rings, 12);
    }

    /// Blocks with a face of the surface, and those beside them.
    [[nodiscard]] std::vector<std::uint8_t> blocks_at(const Surface& surface) const {
        std::vector<std::uint8_t> at_surface(product(grid.lattice), 0);
        const auto mark = [&](const Place& at) {
            if (in_lattice(at)) at_surface[at3(at, grid.lattice)] = 1;
        };
        for (const SurfaceFace& face : surface.faces) {
            Place at{};
            bool inside = true;
            for (std::size_t a = 0; a < 3; ++a) {
                const int v = face.voxel[a] + grid.shift_voxels[a];
                at[a] = v / block_voxels[a];
                inside &= v >= 0 && at[a] < grid.lattice[a];
            }
            if (!inside) continue;
            mark(at);
            for (const Place& step : step_of) mark({at[0] + step[0], at[1] + step[1], at[2] + step[2]});
        }
        return at_surface;
    }

    [[nodiscard]] bool in_lattice(const Place& at) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (at[a] < 0 || at[a] >= grid.lattice[a]) return false;
        return true;
    }

    /// Which blocks get transport cells, and the list of all.
    void find_blocks(double colour_mm, std::span<const std::uint8_t> also, const Surface* requested) {
        want_below(find_surface_blocks(colour_mm, also, requested), colour_mm);
        check();
        if (grid.mixes_core) seed_mixed_where_wanted();
        want_margins();
        want_slivers();
        check();
        list_blocks();
        find_neighbours();
    }

    /// Wants those at the surface, on a sheet that light reaches and in `also`; seeds margins at those of several
    /// materials and those that are lit. The lit ones of what is `asked` for.
    [[nodiscard]] std::vector<Place> find_surface_blocks(double colour_mm, std::span<const std::uint8_t> also,
                                                         const Surface* requested) {
        const std::size_t n = product(grid.lattice);
        const std::vector<std::uint8_t> at_surface =
            requested ? blocks_at(*requested) : std::vector<std::uint8_t>(n, 1);
        wanted.assign(n, 0);
        seed.assign(n, 0);
        std::vector<Place> surface;
        const std::vector<std::uint8_t> deep =
            scene.backing == Backing::none ? std::vector<std::uint8_t>(n, 0) : find_deep(colour_mm);
        std::size_t i = 0;
        for_each(grid.lattice, [&](const Place& at) {
            const std::size_t here = i++;
            if (state[here] == empty) return;
            const bool seeds_margin = material[here] < 0 && !grid.mixes_core;
            if (grid.is_ghost(at)) {
                seed[here] = seeds_margin;
                return;
            }
            const auto [lit, sheet] = beyond(at);
            if (lit && at_surface[here]) surface.push_back(at);
            const bool seen_sheet = sheet && !deep[here];
            if (lit || seen_sheet || (!also.empty() && also[here])) wanted[here] = 1;
            seed[here] = lit || seeds_margin || (seen_sheet && grid.mixes_core);
        });
        return surface;
    }

    /// Which blocks are so deep in one resin that a node of diffusion on a sheet serves as well as cells do
    /// (transport_medium.h). In grids that keep their shape colour is still to come.
    [[nodiscard]] std::vector<std::uint8_t> find_deep(double colour_mm) const {
        double edge = std::numeric_limits<double>::max();
        for (std::size_t a = 0; a < 3; ++a) edge = std::min(edge, block_voxels[a] * grid.pitch_mm[a]);
        std::vector<int> rings_of;
        for (const Resin& resin : scene.resins->resins)
            rings_of.push_back(1 + static_cast<int>(std::ceil((sheet_depth_mm(*scene.resins, resin, grid.directions) +
                                                               (grid.mixes_core ? colour_mm : 0)) /
                                                              edge)));
        std::vector<std::uint8_t> deep(state.size(), 0);
        std::vector<int> ring(state.size(), -1);
        std::vector<Place> front, next_front;
        std::size_t i = 0;
        for_each(grid.lattice, [&](const Place& at) {
            const std::size_t here = i++;
            if (state[here] == empty) return;
            bool other = material[here] < 0 || beyond(at).lit;
            for (std::size_t f = 0; f < 6; ++f)
                if (const Place next = beside(at, f); in_lattice(next)) {
                    const std::size_t there = at3(next, grid.lattice);
                    other |= state[there] != empty && material[there] != material[here];
                }
            if (!other) return;
            ring[here] = 0;
            front.push_back(at);
        });
        for (int r = 1; !front.empty(); ++r) {
            next_front.clear();
            for (const Place& at : front)
                for_each({3, 3, 3}, [&](const Place& k) {
                    const Place next{at[0] + k[0] - 1, at[1] + k[1] - 1, at[2] + k[2] - 1};
                    if (!in_lattice(next)) return;
                    const std::size_t there = at3(next, grid.lattice);
                    if (ring[there] >= 0 || state[there] == empty) return;
                    ring[there] = r;
                    deep[there] = r >= rings_of[static_cast<std::size_t>(material[there]) - 1];
                    next_front.push_back(next);
                });
            front.swap(next_front);
        }
        return deep;
    }

    void seed_mixed_where_wanted() {
        for (std::size_t here = 0; here < seed.size(); ++here) seed[here] |= wanted[here] && material[here] < 0;
    }

    /// Whether all cells of a block that lie at the far side of its neighbour's face f are solid.
    [[nodiscard]] bool covers(const Place& block, std::size_t f) const {
        if (state[at3(block, grid.lattice)] == empty) return false;
        const std::size_t a = f / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        Place cell{4 * block[0], 4 * block[1], 4 * block[2]};
        cell[a] += f % 2 == 1 ? 0 : 3;
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) {
                Place at = cell;
                at[b] += i;
                at[c] += j;
                if (!solid_at(at)) return false;
            }
        return true;
    }

    /// What a block that is not empty has around it.
    struct Beyond {
        bool lit = false, sheet = false;
    };
    [[nodiscard]] Beyond beyond(const Place& at) const {
        Beyond found{!closed[at3(at, grid.lattice)], false};
        for (std::size_t f = 0; f < 6 && !found.lit; ++f) {
            const Place next = beside(at, f);
            const bool inside = in_lattice(next);
            // Beside a block that is full but for what reaches below the sheet there is no light.
            if (inside && (covers(next, f) || (f != 4 && closed[at3(next, grid.lattice)]))) continue;
            Place cell{4 * at[0], 4 * at[1], 4 * at[2]};
            if (f % 2 == 1) cell[f / 2] += 3;
            // A sliver on a sheet may leave no solid cell of its own.
            const FaceKind kind =
                inside && !closed[at3(next, grid.lattice)] ? FaceKind::light : kind_of(beside(cell, f), f);
            found.lit |= kind == FaceKind::light;
            found.sheet |= kind == FaceKind::black_sheet || kind == FaceKind::white_sheet;
        }
        found.sheet |= scene.backing != Backing::none && grid.corner_of(at)[2] <= 0;
        return found;
    }

    /// Wants the blocks near the surface: by the distance from the middle of a surface block to the near side of the
    /// block.
    void want_below(const std::vector<Place>& surface, double colour_mm) {
        std::vector<Place> near;
        Place reach{};
        std::array<double, 3> edge{};
        for (std::size_t a = 0; a < 3; ++a) {
            edge[a] = block_voxels[a] * grid.pitch_mm[a];
            reach[a] = static_cast<int>(std::ceil(colour_mm / edge[a]));
        }
        for_each({2 * reach[0] + 1, 2 * reach[1] + 1, 2 * reach[2] + 1}, [&](const Place& k) {
            double d2 = 0;
            for (std::size_t a = 0; a < 3; ++a)
                d2 += std::pow(std::max(std::abs(k[a] - reach[a]) - 0.5, 0.0) * edge[a], 2);
            if (d2 < colour_mm * colour_mm) near.push_back({k[0] - reach[0], k[1] - reach[1], k[2] - reach[2]});
        });
        for (const Place& at : surface) {
            check();
            for (const Place& k : near) {
                const Place to{at[0] + k[0], at[1] + k[1], at[2] + k[2]};
                if (in_lattice(to)) wanted[at3(to, grid.lattice)] = 1;
            }
        }
    }

    /// Wants the seeds and the rings around them in which light becomes diffuse.
    void want_margins() {
        const int rings = margin.empty() ? 0 : *std::max_element(margin.begin(), margin.end());
        std::vector<std::uint8_t> ring(seed.size(), 255);
        std::vector<Place> front, next_front;
        std::size_t i = 0;
        for_each(grid.lattice, [&](const Place& at) {
            if (seed[i]) {
                ring[i] = 0;
                front.push_back(at);
                wanted[i] = 1;
            }
            ++i;
        });
        for (int r = 1; r <= rings; ++r) {
            next_front.clear();
            for (const Place& at : front)
                for_each({3, 3, 3}, [&](const Place& k) {
                    if (k[0] != 1 && k[1] != 1 && k[2] != 1) return;  // across a face or an edge
                    const Place to{at[0] + k[0] - 1, at[1] + k[1] - 1, at[2] + k[2] - 1};
                    if (!in_lattice(to)) return;
                    const std::size_t there = at3(to, grid.lattice);
                    if (ring[there] != 255 || state[there] == empty) return;
                    ring[there] = static_cast<std::uint8_t>(r);
                    if (r <= margin[there]) wanted[there] = 1;
                    next_front.push_back(to);
                });
            front.swap(next_front);
        }
    }

    /// On a sheet a block may have no solid cell of its own: what it holds are cells of the one above, or its node's.
    void want_slivers() {
        if (!grid.is_on_sheet({0, 0, 0}) || grid.lattice[2] < 2) return;
        const auto plane = static_cast<std::size_t>(grid.lattice[0]) * static_cast<std::size_t>(grid.lattice[1]);
        for (std::size_t here = 0; here < plane; ++here)
            if (state[here] != empty && wanted[here + plane]) wanted[here] = 1;
    }

    void list_blocks() {
        grid.block_at.assign(product(grid.lattice), -1);
        std::size_t i = 0;
        std::int64_t row = -1;
        for_each(grid.lattice, [&](const Place& at) {
            const std::size_t here = i++;
            if (state[here] == empty) return;
            const auto index = static_cast<std::uint32_t>(grid.blocks.size());
            grid.block_at[here] = static_cast<std::int32_t>(index);
            if (!wanted[here] || grid.is_ghost(at)) {
                grid.blocks.push_back(core_block(at, index));
                return;
            }
            GridBlock block;
            block.at = at;
            block.kind = BlockKind::transport;
            block.first_cell = static_cast<std::uint32_t>(64 * grid.transport_blocks.size());
            const std::int64_t this_row = std::int64_t{at[2]} * grid.lattice[1] + at[1];
            if (this_row != row)
                grid.transport_rows.push_back(static_cast<std::uint32_t>(grid.transport_blocks.size()));
            row = this_row;
            grid.transport_blocks.push_back(index);
            grid.blocks.push_back(block);
        });
        grid.transport_rows.push_back(static_cast<std::uint32_t>(grid.transport_blocks.size()));
    }

    /// A block of one node, and perhaps a ghost.
    [[nodiscard]] GridBlock core_block(const Place& at, std::uint32_t index) {
        const std::size_t here = at3(at, grid.lattice);
        GridBlock block;
        block.at = at;
        block.kind = BlockKind::core;
        block.medium = static_cast<std::uint16_t>(material[here]);  // `fill` knows better
        block.core_node = static_cast<std::uint32_t>(grid.core_block.size());
        if (grid.is_ghost(at)) {
            // Whatever it holds: its light is given, and the halo keeps it out of sight.
            if (material[here] < 0) block.medium = some_material(at);
            grid.ghosts.push_back(block.core_node);
        }
        grid.core_block.push_back(index);
        return block;
    }

    void find_neighbours() {
        for (GridBlock& block : grid.blocks)
            for (std::size_t f = 0; f < 6; ++f) {
                const Place next = beside(block.at, f);
                if (in_lattice(next)) block.neighbour[f] = grid.block_at[at3(next, grid.lattice)];
            }
    }

    /// Solid cells, their outer faces, and who gave them resin.
    void list_faces() {
        VOXTONE_EXPECT(64 * grid.transport_blocks.size() < std::numeric_limits<std::uint32_t>::max());
        grid.medium.assign(64 * grid.transport_blocks.size(), 0);
        for (const std::uint32_t b : grid.transport_blocks) {
            check();
            GridBlock& block = grid.blocks[b];
            grid.donors_of.push_back(static_cast<std::uint32_t>(grid.donors.size()));
            if (has_no_outer_face(block)) {
                block.solid = ~std::uint64_t{0};
                continue;
            }
            block.first_face = static_cast<std::uint32_t>(grid.faces.size());
            for_each({4, 4, 4}, [&](const Place& at) { list_faces_of_cell(block, at); });
            block.faces = static_cast<std::uint32_t>(grid.faces.size()) - block.first_face;
            list_by_facing(block);
        }
        grid.donors_of.push_back(static_cast<std::uint32_t>(grid.donors.size()));
    }

    void list_by_facing(GridBlock& block) {
        for (std::size_t facing = 0; facing < 6; ++facing) {
            for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f)
                if (static_cast<std::size_t>(grid.faces[f].facing) == facing)
                    grid.by_facing.push_back(
                        {grid.place_of_face[f], static_cast<std::uint8_t>(grid.faces[f].cell - block.first_cell)});
            block.first_facing[facing + 1] = static_cast<std::uint8_t>(grid.by_facing.size() - block.first_face);
        }
    }

    [[nodiscard]] bool has_no_outer_face(const GridBlock& block) const {
        if (state[at3(block.at, grid.lattice)] != full) return false;
        return std::ranges::all_of(block.neighbour, [&](std::int32_t other) {
            if (other < 0) return false;
            const GridBlock& next = grid.blocks[static_cast<std::size_t>(other)];
            return next.kind != BlockKind::core && state[at3(next.at, grid.lattice)] == full;
        });
    }

    /// Of cell `at` of a block, in order of facing.
    void list_faces_of_cell(GridBlock& block, const Place& at) {
        const Place cell{4 * block.at[0] + at[0], 4 * block.at[1] + at[1], 4 * block.at[2] + at[2]};
        if (!solid_at(cell)) return;
        const std::size_t place = place_in_block(at);
        block.solid |= std::uint64_t{1} << place;
        const std::array<double, 3> edge = grid.edge_mm();
        for (std::size_t f = 0; f < 6; ++f) {
            OuterFace face;
            face.cell = block.first_cell + static_cast<std::uint32_t>(place);
            face.facing = static_cast<Facing>(f);
            face.area_mm2 = static_cast<float>(edge[(f / 2 + 1) % 3] * edge[(f / 2 + 2) % 3]);
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (at[axis] >= 2) face.region_in_block |= static_cast<std::uint8_t>(1u << axis);
            const Place next = beside(cell, f);
            if (solid_at(next)) {
                const Place around{next[0] / 4, next[1] / 4, next[2] / 4};
                const GridBlock& other =
                    grid.blocks[static_cast<std::size_t>(grid.block_at[at3(around, grid.lattice)])];
                if (other.kind == BlockKind::core) add_core_face(face, other);
            } else {
                add_open_face(face, kind_of(next, f));
                if (fill_at(next) > 0 && receiver(next) == cell) add_donor(face.cell, next);
            }
        }
    }

    void add_core_face(OuterFace face, const GridBlock& beyond) {
        face.kind = FaceKind::core;
        face.beyond = beyond.core_node;
        grid.place_of_face.push_back(into_core | static_cast<std::uint32_t>(grid.core_faces.size()));
        grid.core_faces.push_back(static_cast<std::uint32_t>(grid.faces.size()));
        grid.faces.push_back(face);
    }

    void add_open_face(OuterFace face, FaceKind kind) {
        face.kind = kind;
        grid.place_of_face.push_back(static_cast<std::uint32_t>(grid.open_faces.size()));
        grid.open_faces.push_back(static_cast<std::uint32_t>(grid.faces.size()));
        grid.faces.push_back(face);
    }

    void add_donor(std::uint32_t to, const Place& from_cell) {
        Place from{};
        for (std::size_t a = 0; a < 3; ++a) from[a] = from_cell[a] * view[a] - grid.shift_voxels[a];
        grid.donors.push_back({to, from});
    }
};

}  // namespace

ViewingGrid make_viewing_grid(const Scene& scene, const std::array<int, 3>& view_voxels, const ColourDepth& colour,
                              std::span<const std::uint8_t> also, const ViewingWindow& window, const Surface* requested,
                              const Progress* progress) {
    ViewingGrid made = make_empty_viewing_grid(scene, view_voxels, colour, also, window, requested, progress);
    std::vector<std::uint8_t> wanted;
    const bool filled = fill(made, *scene.volume, wanted, progress);
    VOXTONE_ENSURE(filled);
    return made;
}

ViewingGrid make_empty_viewing_grid(const Scene& scene, const std::array<int, 3>& view_voxels,
                                    const ColourDepth& colour, std::span<const std::uint8_t> also,
                                    const ViewingWindow& window, const Surface* requested, const Progress* progress) {
    require_resins(scene);
    ViewingGrid made;
    made.window = window;
    made.mirrored = scene.sides == Sides::mirrored;
    made.backing = scene.backing;
    made.sheet = scene.sheet;
    made.spread = LateralSpread(scene.spread_mm, scene.volume->pitch_mm());
    made.size = scene.volume->size();
    made.resins = scene.resins->resins.size();
    made.mixes_core = colour.deeper_in_nodes;
    made.view_voxels = view_voxels;
    made.directions = make_directions(scene.resins->g, scene.resins->eta);
    made.pitch_mm = scene.volume->pitch_mm();
    ViewingGridBuilder builder{made, scene, progress};
    builder.survey_volume();
    builder.find_blocks(colour.mm, also, requested);
    builder.list_faces();
    find_face_laws(made, scene, progress);
    return made;
}

}  // namespace voxtone::optics
