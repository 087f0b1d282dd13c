// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport/optical_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/transport/lattice.h"

namespace voxtone::optics {

struct OpticalGrid::Builder {
    OpticalGrid& grid;
    const Scene& scene;
    const Progress* progress;
    std::array<int, 3> block_voxels{};
    using Counts = std::vector<std::pair<Material, int>>;
    using Numbers = std::map<Counts, std::uint32_t>;
    Numbers mixtures;  // of the palette

    [[nodiscard]] std::array<int, 3> corner_of(const std::array<int, 3>& block) const {
        std::array<int, 3> corner{};
        for (std::size_t a = 0; a < 3; ++a) corner[a] = block[a] * block_voxels[a] - grid.shift_voxels[a];
        return corner;
    }
    [[nodiscard]] bool mirrored(int axis) const { return scene.sides == Sides::mirrored && axis < 2; }
    void check() const {
        if (progress) progress->check_cancelled();
    }

    [[nodiscard]] bool any_air(const std::array<int, 3>& corner, const std::array<int, 3>& extent) const {
        const int material = scene.volume->uniform_material(corner, extent);
        if (material >= 0) return material == air;
        std::vector<Material> box(product(extent));
        scene.volume->copy_box(corner, extent, box);
        return std::find(box.begin(), box.end(), air) != box.end();
    }

    /// A block of one material, solid all around, or lying on a sheet.
    [[nodiscard]] int buried_material(const std::array<int, 3>& block) const {
        const auto corner = corner_of(block);
        const int material = scene.volume->uniform_material(corner, block_voxels);
        if (material <= 0) return material;
        for (int f = 0; f < 6; ++f) {
            const auto a = static_cast<std::size_t>(f / 2);
            std::array<int, 3> next = corner, extent = block_voxels;
            next[a] = f % 2 == 0 ? corner[a] - 1 : corner[a] + block_voxels[a];
            extent[a] = 1;
            const bool outside = next[a] < 0 || next[a] >= scene.volume->size()[a];
            const bool on_sheet = f == 4 && next[2] < 0 && scene.backing != Backing::none;
            if (outside ? !mirrored(f / 2) && !on_sheet : any_air(next, extent)) return -1;
        }
        return material;
    }

    void lay_lattice() {
        const auto& size = scene.volume->size();
        for (std::size_t a = 0; a < 3; ++a) {
            VOXTONE_EXPECT(grid.options.view_voxels[a] % grid.options.skin_voxels[a] == 0);
            block_voxels[a] = 4 * grid.options.view_voxels[a];
            grid.lattice[a] = (size[a] + block_voxels[a] - 1) / block_voxels[a];
        }
        // The top of the volume is the top of a block: the surface of a slab is cut into whole skin blocks.
        grid.shift_voxels[2] = grid.lattice[2] * block_voxels[2] - size[2];
    }

    void find_blocks() {
        const std::size_t n = product(grid.lattice);
        std::vector<std::int16_t> material(n);  // -1: skin, 0: air, else the buried one
        const std::size_t plane = static_cast<std::size_t>(grid.lattice[0]) * static_cast<std::size_t>(grid.lattice[1]);
        const auto look = [&](std::size_t i) {
            const auto x = static_cast<int>(i % static_cast<std::size_t>(grid.lattice[0]));
            const auto y = static_cast<int>(i / static_cast<std::size_t>(grid.lattice[0]) %
                                            static_cast<std::size_t>(grid.lattice[1]));
            const auto z = static_cast<int>(i / plane);
            material[i] = static_cast<std::int16_t>(buried_material({x, y, z}));
        };
        parallel_for(0, n, std::max<std::size_t>(1, plane / 8), look, progress);
        std::array<int, 256> margin{};
        for (std::size_t m = 1; m < grid.palette.size(); ++m) margin[m] = margin_blocks(m);
        const int rings = *std::max_element(margin.begin(), margin.end()) + grid.options.fine_core_blocks;
        std::vector<std::uint8_t> ring(n, 255);
        for (std::size_t i = 0; i < n; ++i)
            if (material[i] == -1) ring[i] = 0;
        for (int r = 1; r <= rings; ++r) {
            check();
            grow(ring, r);
        }
        check();
        grid.block_at.assign(n, -1);
        std::size_t i = 0;
        for_each(grid.lattice, [&](const std::array<int, 3>& at) {
            const std::size_t here = i++;
            if (material[here] == 0) return;
            GridBlock block;
            block.at = {at[0], at[1], at[2]};
            const int r = ring[here];
            const int depth = material[here] > 0 ? margin[static_cast<std::size_t>(material[here])] : 0;
            block.kind = r == 0 ? BlockKind::skin : r <= depth ? BlockKind::margin : BlockKind::core;
            // A sheet takes what diffusion would not give it: light meets it in transport cells, coarse ones.
            const bool on_sheet = scene.backing != Backing::none && corner_of(at)[2] <= 0;
            if (on_sheet && block.kind == BlockKind::core && material[here] > 0) block.kind = BlockKind::margin;
            block.nodes_per_edge = block.kind != BlockKind::core                ? 4
                                   : r <= depth + grid.options.fine_core_blocks ? 2
                                                                                : 1;
            if (material[here] > 0) block.medium = static_cast<std::uint16_t>(material[here]);
            grid.block_at[here] = static_cast<std::int32_t>(grid.blocks.size());
            grid.blocks.push_back(block);
        });
        for (GridBlock& block : grid.blocks)
            for (std::size_t f = 0; f < 6; ++f) {
                std::array<int, 3> next{};
                bool inside = true;
                for (std::size_t a = 0; a < 3; ++a) {
                    next[a] = block.at[a] + step_of[f][a];
                    inside &= next[a] >= 0 && next[a] < grid.lattice[a];
                }
                if (inside) block.neighbour[f] = grid.block_at[at3(next, grid.lattice)];
            }
        std::int64_t row = -1;
        for (std::size_t b = 0; b < grid.blocks.size(); ++b) {
            const GridBlock& block = grid.blocks[b];
            if (block.kind == BlockKind::core) continue;
            const std::int64_t this_row = std::int64_t{block.at[2]} * grid.lattice[1] + block.at[1];
            if (this_row != row)
                grid.transport_rows.push_back(static_cast<std::uint32_t>(grid.transport_blocks.size()));
            row = this_row;
            grid.transport_blocks.push_back(static_cast<std::uint32_t>(b));
        }
        grid.transport_rows.push_back(static_cast<std::uint32_t>(grid.transport_blocks.size()));
    }

    /// Light becomes diffuse over transport mean free paths: rings of margin blocks for a material, in its clearest
    /// channel.
    [[nodiscard]] int margin_blocks(std::size_t material) const {
        constexpr double free_paths = 2.3;
        double least = 1e9, edge = 0;
        for (std::size_t c = 0; c < scene.resins->channels.size(); ++c) {
            const Medium m = scene.resins->resins[material - 1].medium(c);
            least = std::min(least, m.sigma_a + (1 - scene.resins->g) * m.sigma_s);
        }
        for (std::size_t a = 0; a < 3; ++a) edge = std::max(edge, block_voxels[a] * grid.pitch_mm[a]);
        const double wanted = free_paths / (std::max(least, 1e-3) * edge);
        return std::max(grid.options.margin_blocks, static_cast<int>(std::min(12.0, std::ceil(wanted - 0.1))));
    }

    /// Places that touch ring r - 1 by a face, an edge or a corner become ring r.
    void grow(std::vector<std::uint8_t>& ring, int r) const {
        std::vector<std::size_t> found;
        std::size_t i = 0;
        for_each(grid.lattice, [&](const std::array<int, 3>& at) {
            const std::size_t here = i++;
            if (ring[here] != 255) return;
            for (int z = std::max(at[2] - 1, 0); z <= std::min(at[2] + 1, grid.lattice[2] - 1); ++z)
                for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, grid.lattice[1] - 1); ++y)
                    for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, grid.lattice[0] - 1); ++x)
                        if (ring[at3({x, y, z}, grid.lattice)] == r - 1) {
                            found.push_back(here);
                            return;
                        }
        });
        for (const std::size_t here : found) ring[here] = static_cast<std::uint8_t>(r);
    }

    static PaletteEntry entry_of(const Counts& counts) {
        int all = 0;
        for (const auto& [m, n] : counts) all += n;
        PaletteEntry entry;
        for (const auto& [m, n] : counts) entry.shares.emplace_back(m, static_cast<float>(n) / static_cast<float>(all));
        return entry;
    }

    /// Sum of the differences of all shares.
    static float distance(const PaletteEntry& a, const PaletteEntry& b) {
        float sum = 0;
        auto i = a.shares.begin(), j = b.shares.begin();
        while (i != a.shares.end() || j != b.shares.end()) {
            if (j == b.shares.end() || (i != a.shares.end() && i->first < j->first))
                sum += (i++)->second;
            else if (i == a.shares.end() || j->first < i->first)
                sum += (j++)->second;
            else
                sum += std::abs((i++)->second - (j++)->second);
        }
        return sum;
    }

    /// The number of a mixture; in a full palette that of the nearest one.
    static std::uint32_t intern(Counts counts, Numbers& numbers, std::vector<PaletteEntry>& palette, std::size_t most) {
        std::sort(counts.begin(), counts.end());
        if (const auto found = numbers.find(counts); found != numbers.end()) return found->second;
        PaletteEntry entry = entry_of(counts);
        auto number = static_cast<std::uint32_t>(palette.size());
        if (palette.size() < most) {
            palette.push_back(std::move(entry));
        } else {
            const auto nearest = std::min_element(
                palette.begin() + 1, palette.end(),
                [&](const PaletteEntry& a, const PaletteEntry& b) { return distance(a, entry) < distance(b, entry); });
            number = static_cast<std::uint32_t>(nearest - palette.begin());
        }
        numbers.emplace(std::move(counts), number);
        return number;
    }

    /// Media of the skin cells of a block with a margin of one cell; 0 where a cell is less than half solid.
    std::vector<std::uint16_t> skin_media(const GridBlock& block, const std::array<int, 3>& cells) {
        const auto& cell = grid.options.skin_voxels;
        std::array<int, 3> corner = corner_of({block.at[0], block.at[1], block.at[2]}), extent{}, padded{};
        for (std::size_t a = 0; a < 3; ++a) {
            corner[a] -= cell[a];
            extent[a] = block_voxels[a] + 2 * cell[a];
            padded[a] = cells[a] + 2;
        }
        std::vector<Material> voxels(product(extent));
        scene.volume->copy_box(corner, extent, voxels);
        const int in_cell = cell[0] * cell[1] * cell[2];
        std::vector<std::uint16_t> media(product(padded), 0);
        std::size_t i = 0;
        for_each(padded, [&](const std::array<int, 3>& at) {
            std::uint16_t& medium = media[i++];
            const std::array<int, 3> low{at[0] * cell[0], at[1] * cell[1], at[2] * cell[2]};
            if (in_cell == 1) {
                medium = voxels[at3(low, extent)];
                return;
            }
            Counts counts;
            int solid = 0;
            for_each(cell, [&](const std::array<int, 3>& in) {
                const Material m = voxels[at3({low[0] + in[0], low[1] + in[1], low[2] + in[2]}, extent)];
                if (m == air) return;
                ++solid;
                const auto same =
                    std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.first == m; });
                if (same == counts.end())
                    counts.emplace_back(m, 1);
                else
                    ++same->second;
            });
            if (2 * solid < in_cell) return;
            medium = counts.size() == 1 ? counts[0].first
                                        : static_cast<std::uint16_t>(intern(std::move(counts), mixtures, grid.palette,
                                                                            grid.options.most_mixtures));
        });
        return media;
    }

    void fill_cells() {
        for (const std::uint32_t b : grid.transport_blocks) {
            check();
            GridBlock& block = grid.blocks[b];
            const auto cells = grid.cells_in(block.kind);
            const auto voxels = grid.voxels_in(block.kind);
            block.first_cell = static_cast<std::uint32_t>(grid.medium.size());
            VOXTONE_EXPECT(grid.medium.size() + product(cells) < std::numeric_limits<std::uint32_t>::max());
            const auto edge = grid.edge_mm(block.kind);
            const std::array<int, 3> padded{cells[0] + 2, cells[1] + 2, cells[2] + 2};
            std::vector<std::uint16_t> media =
                block.kind == BlockKind::skin
                    ? skin_media(block, cells)
                    : std::vector<std::uint16_t>(product(padded), static_cast<std::uint16_t>(block.medium));
            const std::array<int, 3> corner = corner_of({block.at[0], block.at[1], block.at[2]});
            std::size_t outer_cells = 0;
            for_each(cells, [&](const std::array<int, 3>& at) {
                const std::uint16_t medium = media[at3({at[0] + 1, at[1] + 1, at[2] + 1}, padded)];
                std::uint8_t outer = medium == 0 ? not_solid : 0;
                for (std::size_t f = 0; medium != 0 && f < 6; ++f)
                    if (borders(block, cells, voxels, corner, at, f, media, padded))
                        outer |= static_cast<std::uint8_t>(1u << f);
                grid.medium.push_back(medium);
                grid.outer.push_back(outer);
                outer_cells += medium != 0 && outer != 0;
            });
            number_nodes(block, cells, media, padded);
            if (outer_cells > 0) list_faces(block, cells, voxels, corner, edge, media, padded);
        }
    }

    /// Does face f of a solid cell lead out of the transport region?
    [[nodiscard]] bool borders(const GridBlock& block, const std::array<int, 3>& cells,
                               const std::array<int, 3>& voxels, const std::array<int, 3>& corner,
                               const std::array<int, 3>& at, std::size_t f, const std::vector<std::uint16_t>& media,
                               const std::array<int, 3>& padded) const {
        const std::size_t a = f / 2;
        std::array<int, 3> next = at;
        next[a] += step_of[f][a];
        const bool leaves_block = next[a] < 0 || next[a] >= cells[a];
        const int voxel = corner[a] + next[a] * voxels[a];
        if (voxel + voxels[a] <= 0 || voxel >= scene.volume->size()[a]) return true;
        if (leaves_block) {
            const std::int32_t other = block.neighbour[f];
            if (other < 0 || grid.blocks[static_cast<std::size_t>(other)].kind == BlockKind::core) return true;
        }
        return media[at3({next[0] + 1, next[1] + 1, next[2] + 1}, padded)] == 0;
    }

    void number_nodes(GridBlock& block, const std::array<int, 3>& cells, const std::vector<std::uint16_t>& media = {},
                      const std::array<int, 3>& padded = {}) {
        check();
        block.first_node = static_cast<std::uint32_t>(grid.nodes.size());
        const auto b = static_cast<std::uint32_t>(&block - grid.blocks.data());
        if (block.kind == BlockKind::core) {
            number_core_nodes(block, b);
            return;
        }
        std::array<int, 64> solid{};
        std::array<std::array<int, 3>, 64> open{};
        std::size_t cell = block.first_cell;
        for_each(cells, [&](const std::array<int, 3>& at) {
            if (grid.medium[cell++] == 0) return;
            const auto place = static_cast<std::size_t>(((at[2] * 4 / cells[2]) * 4 + at[1] * 4 / cells[1]) * 4 +
                                                        at[0] * 4 / cells[0]);
            ++solid[place];
            for (std::size_t a = 0; a < 3; ++a) {
                if ((at[a] + 1) % (cells[a] / 4) != 0) continue;
                std::array<int, 3> next{at[0] + 1, at[1] + 1, at[2] + 1};
                ++next[a];
                open[place][a] += media[at3(next, padded)] != 0;
            }
        });
        const float whole = static_cast<float>(product(cells)) / 64.0f;
        for_each({4, 4, 4}, [&](const std::array<int, 3>& at) {
            const auto place = static_cast<std::size_t>((at[2] * 4 + at[1]) * 4 + at[0]);
            if (solid[place] == 0) return;
            block.node_mask |= std::uint64_t{1} << place;
            GridNode node;
            for (std::size_t a = 0; a < 3; ++a) node.centre[a] = static_cast<float>(4 * block.at[a] + at[a]) + 0.5f;
            node.solid_share = static_cast<float>(solid[place]) / whole;
            for (std::size_t a = 0; a < 3; ++a)
                node.open_share[a] = static_cast<float>(open[place][a]) * static_cast<float>(cells[a] / 4) / whole;
            grid.nodes.push_back(node);
            grid.node_block.push_back(b);
        });
    }

    /// Nodes of a core block, 8 or 1.
    void number_core_nodes(GridBlock& block, std::uint32_t index) {
        const int n = block.nodes_per_edge;
        const float edge = 4.0f / static_cast<float>(n);
        int place = 0;
        for_each({n, n, n}, [&](const std::array<int, 3>& at) {
            GridNode node;
            for (std::size_t a = 0; a < 3; ++a)
                node.centre[a] = static_cast<float>(4 * block.at[a]) + (static_cast<float>(at[a]) + 0.5f) * edge;
            node.edge_cells = edge;
            block.node_mask |= std::uint64_t{1} << place++;
            grid.nodes.push_back(node);
            grid.node_block.push_back(index);
        });
    }

    void list_faces(GridBlock& block, const std::array<int, 3>& cells, const std::array<int, 3>& voxels,
                    const std::array<int, 3>& corner, const std::array<double, 3>& edge,
                    const std::vector<std::uint16_t>& media, const std::array<int, 3>& padded) {
        block.first_link = static_cast<std::int32_t>(grid.face_of_cell.size());
        block.first_face = static_cast<std::uint32_t>(grid.faces.size());
        std::uint32_t cell = block.first_cell;
        for_each(cells, [&](const std::array<int, 3>& at) {
            const std::uint32_t here = cell++;
            grid.face_of_cell.push_back(static_cast<std::int32_t>(grid.faces.size()));
            if (grid.outer[here] & not_solid) return;
            for (std::size_t f = 0; f < 6; ++f) {
                if (!(grid.outer[here] & (1u << f))) continue;
                const std::size_t a = f / 2;
                OuterFace face;
                face.cell = here;
                face.node = static_cast<std::uint32_t>(
                    grid.node_at(block, at[0] * 4 / cells[0], at[1] * 4 / cells[1], at[2] * 4 / cells[2]));
                face.facing = static_cast<Facing>(f);
                for (std::size_t axis = 0; axis < 3; ++axis)
                    if (at[axis] * 2 >= cells[axis]) face.region_in_block |= static_cast<std::uint8_t>(1u << axis);
                face.area_mm2 = static_cast<float>(edge[(a + 1) % 3] * edge[(a + 2) % 3]);
                const int voxel = corner[a] + (at[a] + step_of[f][a]) * voxels[a];
                const bool outside = voxel + voxels[a] <= 0 || voxel >= scene.volume->size()[a];
                if (outside && mirrored(static_cast<int>(a)))
                    face.kind = FaceKind::mirror;
                else if (outside && f == 4 && scene.backing == Backing::black)
                    face.kind = FaceKind::black_sheet;
                else if (outside && f == 4 && scene.backing == Backing::white)
                    face.kind = FaceKind::white_sheet;
                else if (borders_core(block, cells, at, f, media, padded))
                    face.kind = FaceKind::core;
                grid.faces.push_back(face);
            }
        });
        block.faces = static_cast<std::uint32_t>(grid.faces.size()) - block.first_face;
    }
    /// Is there resin of a core block beyond face f?
    [[nodiscard]] bool borders_core(const GridBlock& block, const std::array<int, 3>& cells,
                                    const std::array<int, 3>& at, std::size_t f,
                                    const std::vector<std::uint16_t>& media, const std::array<int, 3>& padded) const {
        const std::size_t a = f / 2;
        std::array<int, 3> next = at;
        next[a] += step_of[f][a];
        if (next[a] >= 0 && next[a] < cells[a]) return false;
        if (media[at3({next[0] + 1, next[1] + 1, next[2] + 1}, padded)] == 0) return false;
        const std::int32_t other = block.neighbour[f];
        return other >= 0 && grid.blocks[static_cast<std::size_t>(other)].kind == BlockKind::core;
    }

    void connect() {
        // Core faces learn what lies beyond only now that all nodes have numbers.
        for (const std::uint32_t b : grid.transport_blocks) {
            check();
            const GridBlock& block = grid.blocks[b];
            if (block.first_link < 0) continue;
            const auto cells = grid.cells_in(block.kind);
            std::uint32_t cell = block.first_cell;
            for_each(cells, [&](const std::array<int, 3>& at) {
                const std::uint32_t here = cell++;
                if (grid.outer[here] & not_solid) return;
                auto face = static_cast<std::size_t>(
                    grid.face_of_cell[static_cast<std::size_t>(block.first_link) + (here - block.first_cell)]);
                for (std::size_t f = 0; f < 6; ++f) {
                    if (!(grid.outer[here] & (1u << f))) continue;
                    OuterFace& outer = grid.faces[face++];
                    if (outer.kind != FaceKind::core) continue;
                    std::array<int, 3> place{at[0] * 4 / cells[0], at[1] * 4 / cells[1], at[2] * 4 / cells[2]};
                    place[f / 2] = f % 2 == 0 ? 3 : 0;
                    const std::int64_t beyond = grid.node_at(grid.blocks[static_cast<std::size_t>(block.neighbour[f])],
                                                             place[0], place[1], place[2]);
                    VOXTONE_ENSURE(beyond >= 0);
                    outer.beyond = static_cast<std::uint32_t>(beyond);
                }
            });
        }
        std::vector<NodeContact> found;
        std::array<double, 3> view{};
        for (std::size_t a = 0; a < 3; ++a) view[a] = grid.pitch_mm[a] * grid.options.view_voxels[a];
        for (const GridBlock& block : grid.blocks) {
            check();
            found.clear();
            for_each({4, 4, 4}, [&](const std::array<int, 3>& at) {
                const std::int64_t a = grid.node_at(block, at[0], at[1], at[2]);
                if (a < 0) return;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    std::array<int, 3> next = at;
                    const GridBlock* other = &block;
                    if (++next[axis] == 4) {
                        next[axis] = 0;
                        const std::int32_t n = block.neighbour[2 * axis + 1];
                        if (n < 0) continue;
                        other = &grid.blocks[static_cast<std::size_t>(n)];
                    }
                    const std::int64_t b = grid.node_at(*other, next[0], next[1], next[2]);
                    if (b < 0 || b == a) continue;
                    const float share = grid.nodes[static_cast<std::size_t>(a)].open_share[axis];
                    if (share <= 0) continue;
                    const auto area = static_cast<float>(view[(axis + 1) % 3] * view[(axis + 2) % 3]) * share;
                    found.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                     static_cast<std::uint8_t>(axis), area});
                }
            });
            std::sort(found.begin(), found.end(), [](const NodeContact& p, const NodeContact& q) {
                return std::pair(p.a, p.b) < std::pair(q.a, q.b);
            });
            for (const NodeContact& contact : found) {
                if (!grid.contacts.empty() && grid.contacts.back().a == contact.a &&
                    grid.contacts.back().b == contact.b)
                    grid.contacts.back().area_mm2 += contact.area_mm2;
                else
                    grid.contacts.push_back(contact);
            }
        }
    }

    /// What every outer face lets through, from the normals of the smooth surface. Normals are rounded to steps of a
    /// degree or so: few laws serve all faces.
    void see_surface() {
        grid.laws.push_back(mirror_law());
        for (int axis = 0; axis < 3; ++axis) {
            std::array<float, 3> normal{};
            normal[static_cast<std::size_t>(axis)] = 1;
            grid.laws.push_back(face_law(grid.directions, axis, normal));
        }
        grid.law.resize(grid.faces.size());
        for (std::size_t f = 0; f < grid.faces.size(); ++f) {
            const OuterFace& face = grid.faces[f];
            const bool opaque = face.kind == FaceKind::mirror || face.kind == FaceKind::core;
            grid.law[f] = opaque ? 0 : 1 + static_cast<std::uint32_t>(face.facing) / 2;
        }
        const Surface surface = find_surface(scene, grid.options.view_voxels, SurfacePart::all, progress);
        std::map<std::array<int, 3>, std::uint32_t> known;
        for (std::size_t i = 0; i < surface.faces.size(); ++i) {
            if (i % 4096 == 0) check();
            const auto& normal = surface.face_normal[i];
            const auto axis = static_cast<std::size_t>(surface.faces[i].facing) / 2;
            if (std::abs(normal[axis]) > 0.99999f) continue;
            const std::int64_t f = grid.face_at(surface.faces[i]);
            if (f < 0) continue;
            const std::size_t b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
            constexpr float steps = 48;
            const std::array<int, 3> key{static_cast<int>(axis), static_cast<int>(std::lround(steps * normal[b])),
                                         static_cast<int>(std::lround(steps * normal[c]))};
            const auto [found, fresh] = known.try_emplace(key, static_cast<std::uint32_t>(grid.laws.size()));
            if (fresh) {
                std::array<float, 3> rounded{};
                rounded[b] = static_cast<float>(key[1]) / steps;
                rounded[c] = static_cast<float>(key[2]) / steps;
                rounded[axis] = std::sqrt(std::max(1e-4f, 1 - rounded[b] * rounded[b] - rounded[c] * rounded[c]));
                grid.laws.push_back(face_law(grid.directions, static_cast<int>(axis), rounded));
            }
            grid.law[static_cast<std::size_t>(f)] = found->second;
        }
        pool();
    }

    /// How much light that passes corners of the staircase each region can take in, per direction.
    void pool() {
        check();
        for (const std::uint32_t b : grid.transport_blocks) {
            GridBlock& block = grid.blocks[b];
            bool flat = true;
            for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) flat &= grid.law_of(f).flat;
            if (flat) continue;
            block.first_region = static_cast<std::int32_t>(grid.regions);
            grid.regions += 8;
        }
        grid.pool_out.assign(grid.regions * 64, 0.0f);
        grid.pool_in.assign(grid.regions * 64, 0.0f);
        for (const std::uint32_t b : grid.transport_blocks) {
            const GridBlock& block = grid.blocks[b];
            if (block.first_region < 0) continue;
            check();
            for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
                const FaceLaw& law = grid.law_of(f);
                if (law.flat) continue;
                const OuterFace& face = grid.faces[f];
                const Octet& cosine = grid.directions.cosine[static_cast<std::size_t>(face.facing) / 2];
                const std::size_t region = (static_cast<std::size_t>(block.first_region) + face.region_in_block) * 64;
                for (int signs = 0; signs < 4; ++signs) {
                    const auto slot = static_cast<std::size_t>(signs);
                    const std::size_t out = region + static_cast<std::size_t>(leaving_octant(face.facing, signs)) * 8,
                                      in = region + static_cast<std::size_t>(entering_octant(face.facing, signs)) * 8;
                    for (std::size_t d = 0; d < 8; ++d) {
                        const float flux = grid.directions.weight.v[d] * cosine.v[d] * face.area_mm2;
                        grid.pool_out[out + d] += flux * law.left_over(slot, d);
                        grid.pool_in[in + d] += flux * law.room(slot, d);
                    }
                }
            }
        }
    }
};

OpticalGrid::OpticalGrid(const Scene& scene, const GridOptions& opts, const Progress* progress)
    : options(opts),
      directions(make_directions(scene.resins->g, scene.resins->eta)),
      pitch_mm(scene.volume->pitch_mm()) {
    require_resins(scene);
    Builder builder{*this, scene, progress, {}, {}};
    palette.resize(scene.resins->resins.size() + 1);
    for (std::size_t m = 1; m < palette.size(); ++m) palette[m].shares = {{static_cast<Material>(m), 1.0f}};
    VOXTONE_EXPECT(options.most_mixtures >= palette.size() && options.most_mixtures <= 65535);
    builder.lay_lattice();
    builder.find_blocks();
    builder.fill_cells();
    for (GridBlock& block : blocks)
        if (block.kind == BlockKind::core) builder.number_nodes(block, {});
    builder.connect();
    builder.see_surface();
}

namespace {

// Moments three times and geometry; a skin block has an outer face for every fourth cell of a side, in and out; a node
// has three contacts on the finest level of the equations and a seventh more on the others.
constexpr std::size_t per_cell = 3 * 16 + 3 + 4, per_face = 2 * 128 + 52, per_node = 460;

}  // namespace

GridCensus::GridCensus(const Scene& scene, const GridOptions& options, const Progress* progress) {
    OpticalGrid grid;
    grid.options = options;
    grid.pitch_mm = scene.volume->pitch_mm();
    grid.palette.resize(scene.resins->resins.size() + 1);
    OpticalGrid::Builder builder{grid, scene, progress, {}, {}};
    builder.lay_lattice();
    builder.find_blocks();
    const std::size_t skin_cells = product(grid.cells_in(BlockKind::skin));
    for (const GridBlock& block : grid.blocks) {
        const auto edge = static_cast<std::size_t>(block.nodes_per_edge);
        other_ += edge * edge * edge * per_node;
        if (block.kind == BlockKind::skin) skin_ += skin_cells * (per_cell + per_face / 16);
        if (block.kind == BlockKind::margin) other_ += 64 * per_cell;
    }
}

std::size_t GridCensus::bytes(std::size_t split) const { return split * skin_ + other_; }

std::array<int, 3> OpticalGrid::cells_in(BlockKind kind) const {
    if (kind != BlockKind::skin) return {4, 4, 4};
    std::array<int, 3> n{};
    for (std::size_t a = 0; a < 3; ++a) n[a] = 4 * options.view_voxels[a] / options.skin_voxels[a];
    return n;
}

std::array<int, 3> OpticalGrid::voxels_in(BlockKind kind) const {
    return kind == BlockKind::skin ? options.skin_voxels : options.view_voxels;
}

std::array<double, 3> OpticalGrid::edge_mm(BlockKind kind) const {
    const auto voxels = voxels_in(kind);
    return {voxels[0] * pitch_mm[0], voxels[1] * pitch_mm[1], voxels[2] * pitch_mm[2]};
}

std::int64_t OpticalGrid::node_at(const GridBlock& block, int i, int j, int k) const {
    int place = (k * 4 + j) * 4 + i;
    switch (block.nodes_per_edge) {
        case 1:
            place = 0;
            break;
        case 2:
            place = ((k / 2) * 2 + j / 2) * 2 + i / 2;
            break;
        default:
            break;
    }
    if (!(block.node_mask >> place & 1)) return -1;
    return block.first_node + std::popcount(block.node_mask & ((std::uint64_t{1} << place) - 1));
}

std::int64_t OpticalGrid::cell_at(const std::array<int, 3>& voxel) const {
    std::array<int, 3> block{}, in{};
    for (std::size_t a = 0; a < 3; ++a) {
        const int v = voxel[a] + shift_voxels[a], edge = 4 * options.view_voxels[a];
        if (v < 0 || v >= lattice[a] * edge) return -1;
        block[a] = v / edge;
        in[a] = v % edge;
    }
    const std::int32_t b = block_at[at3(block, lattice)];
    if (b < 0 || blocks[static_cast<std::size_t>(b)].kind == BlockKind::core) return -1;
    const GridBlock& home = blocks[static_cast<std::size_t>(b)];
    const auto voxels = voxels_in(home.kind);
    return home.first_cell + static_cast<std::int64_t>(
                                 at3({in[0] / voxels[0], in[1] / voxels[1], in[2] / voxels[2]}, cells_in(home.kind)));
}

std::int64_t OpticalGrid::face_at(const SurfaceFace& face) const {
    const std::int64_t cell = cell_at(face.voxel);
    if (cell < 0) return -1;
    const std::uint8_t bits = outer[static_cast<std::size_t>(cell)];
    const auto f = static_cast<unsigned>(face.facing);
    if ((bits & not_solid) || !(bits >> f & 1)) return -1;
    std::array<int, 3> block{};
    for (std::size_t a = 0; a < 3; ++a) block[a] = (face.voxel[a] + shift_voxels[a]) / (4 * options.view_voxels[a]);
    const GridBlock& home = blocks[static_cast<std::size_t>(block_at[at3(block, lattice)])];
    const std::int32_t first = face_of_cell[static_cast<std::size_t>(home.first_link + (cell - home.first_cell))];
    return first + std::popcount(static_cast<unsigned>(bits & ((1u << f) - 1)));
}

std::size_t OpticalGrid::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(blocks) + of(block_at) + of(transport_rows) + of(transport_blocks) + of(medium) + of(outer) +
           of(face_of_cell) + of(faces) + of(laws) + of(law) + of(pool_out) + of(pool_in) + of(nodes) + of(node_block) +
           of(contacts);
}

}  // namespace voxtone::optics
