// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/viewing_grid_builder.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/contracts.h"
#include "optics/grid/block_contents.h"
#include "optics/grid/homogenisation.h"
#include "optics/grid/viewing_faces.h"
#include "optics/media/mirrored_box.h"

namespace voxtone::optics {
namespace {

/// Writes down the blocks of a window and the faces of their cells.
class GridLister {
public:
    GridLister(ViewingGrid& grid, const ResinVolume& volume, const BlockContents& contents, const Progress* progress)
        : grid_(grid), volume_(volume), contents_(contents), progress_(progress) {}

    void list_blocks(std::span<const std::uint8_t> with_cells) {
        grid_.block_at.assign(contents_.size(), -1);
        std::size_t i = 0;
        std::int64_t row = -1;
        for_each(grid_.lattice, [&](const Place& at) {
            const std::size_t here = i++;
            if (contents_[here].empty()) return;
            grid_.block_at[here] = static_cast<std::int32_t>(grid_.blocks.size());
            if (!with_cells[here] || grid_.is_ghost(at)) {
                add_core_block(at);
                return;
            }
            const auto t = static_cast<std::uint32_t>(grid_.transport_blocks.size());
            const std::int64_t this_row = std::int64_t{at[2]} * grid_.lattice[1] + at[1];
            if (std::exchange(row, this_row) != this_row) grid_.transport_rows.push_back(t);
            grid_.transport_blocks.push_back(static_cast<std::uint32_t>(grid_.blocks.size()));
            GridBlock& block = grid_.blocks.emplace_back();
            block.at = at;
            block.kind = BlockKind::transport;
            block.first_cell = 64 * t;
        });
        grid_.transport_rows.push_back(static_cast<std::uint32_t>(grid_.transport_blocks.size()));
        for (GridBlock& block : grid_.blocks)
            for (std::size_t f = 0; f < 6; ++f)
                if (const Place next = beside(block.at, f); lies_in(next, grid_.lattice))
                    block.neighbour[f] = grid_.block_at[at3(next, grid_.lattice)];
    }

    /// Solid cells, their outer faces, and who gave them resin.
    void list_faces() {
        VOXTONE_EXPECT(64 * grid_.transport_blocks.size() < std::numeric_limits<std::uint32_t>::max());
        grid_.medium.assign(64 * grid_.transport_blocks.size(), 0);
        for (const std::uint32_t b : grid_.transport_blocks) {
            if (progress_) progress_->check_cancelled();
            GridBlock& block = grid_.blocks[b];
            grid_.donors_of.push_back(static_cast<std::uint32_t>(grid_.donors.size()));
            if (has_no_outer_face(block)) {
                block.solid = ~std::uint64_t{0};
                continue;
            }
            block.first_face = static_cast<std::uint32_t>(grid_.faces.size());
            for_each({4, 4, 4}, [&](const Place& at) { list_faces_of_cell(block, at); });
            block.faces = static_cast<std::uint32_t>(grid_.faces.size()) - block.first_face;
            list_by_facing(block);
        }
        grid_.donors_of.push_back(static_cast<std::uint32_t>(grid_.donors.size()));
    }

private:
    /// A block of one node, and perhaps a ghost.
    void add_core_block(const Place& at) {
        std::int16_t material = contents_[at].material;
        GridBlock block;
        block.at = at;
        block.kind = BlockKind::core;
        block.core_node = static_cast<std::uint32_t>(grid_.core_block.size());
        if (grid_.is_ghost(at)) {
            // Whatever it holds: its light is given, and the halo keeps it out of sight.
            if (material < 0) material = some_material(at);
            grid_.ghosts.push_back(block.core_node);
        }
        grid_.core_block.push_back(static_cast<std::uint32_t>(grid_.blocks.size()));
        grid_.core_medium.push_back(static_cast<std::uint16_t>(material));  // homogenise knows better
        grid_.blocks.push_back(block);
    }

    [[nodiscard]] Material some_material(const Place& block) const {
        std::vector<Material> box;
        read_box(volume_, grid_.mirrored, grid_.corner_of(block), grid_.block_voxels(), box);
        return *std::ranges::max_element(box);
    }

    [[nodiscard]] bool has_no_outer_face(const GridBlock& block) const {
        return contents_[block.at].full && std::ranges::all_of(block.neighbour, [&](std::int32_t other) {
                   if (other < 0) return false;
                   const GridBlock& next = grid_.blocks[static_cast<std::size_t>(other)];
                   return next.kind != BlockKind::core && contents_[next.at].full;
               });
    }

    /// Of cell `at` of a block, in order of facing.
    void list_faces_of_cell(GridBlock& block, const Place& at) {
        const Place cell{4 * block.at[0] + at[0], 4 * block.at[1] + at[1], 4 * block.at[2] + at[2]};
        if (!contents_.is_solid(cell)) return;
        const std::size_t place = place_in_block(at);
        block.solid |= std::uint64_t{1} << place;
        const std::array<double, 3> edge = grid_.edge_mm();
        OuterFace face;
        face.cell = block.first_cell + static_cast<std::uint32_t>(place);
        face.region_in_block = static_cast<std::uint8_t>(at[0] / 2 | at[1] / 2 << 1 | at[2] / 2 << 2);
        for (std::size_t f = 0; f < 6; ++f) {
            face.facing = static_cast<Facing>(f);
            face.area_mm2 = static_cast<float>(edge[(f / 2 + 1) % 3] * edge[(f / 2 + 2) % 3]);
            const Place next = beside(cell, f);
            if (contents_.is_solid(next)) {
                const Place around{next[0] / 4, next[1] / 4, next[2] / 4};
                const GridBlock& other =
                    grid_.blocks[static_cast<std::size_t>(grid_.block_at[at3(around, grid_.lattice)])];
                if (other.kind == BlockKind::core) add_face(face, FaceKind::core, other.core_node);
            } else {
                add_face(face, grid_.kind_beyond(next, f), 0);
                if (contents_.fill_of(next) > 0 && contents_.receiver(next) == cell)
                    grid_.donors.push_back({face.cell, grid_.corner_of_cell(next)});
            }
        }
    }

    void add_face(OuterFace face, FaceKind kind, std::uint32_t beyond) {
        const bool core = kind == FaceKind::core;
        std::vector<std::uint32_t>& list = core ? grid_.core_faces : grid_.open_faces;
        face.kind = kind;
        face.beyond = beyond;
        grid_.place_of_face.push_back(static_cast<std::uint32_t>(list.size()) | (core ? into_core : 0));
        list.push_back(static_cast<std::uint32_t>(grid_.faces.size()));
        grid_.faces.push_back(face);
    }

    void list_by_facing(GridBlock& block) {
        for (std::size_t facing = 0; facing < 6; ++facing) {
            for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f)
                if (static_cast<std::size_t>(grid_.faces[f].facing) == facing)
                    grid_.by_facing.push_back(
                        {grid_.place_of_face[f], static_cast<std::uint8_t>(grid_.faces[f].cell - block.first_cell)});
            block.first_facing[facing + 1] = static_cast<std::uint8_t>(grid_.by_facing.size() - block.first_face);
        }
    }

    ViewingGrid& grid_;
    const ResinVolume& volume_;
    const BlockContents& contents_;
    const Progress* progress_;
};

}  // namespace

ViewingGrid make_viewing_grid(const Scene& scene, const std::array<int, 3>& view_voxels, const ColourDepth& colour,
                              std::span<const std::uint8_t> also, const ViewingWindow& window, const Surface* requested,
                              const Progress* progress) {
    ViewingGrid made = make_empty_viewing_grid(scene, view_voxels, colour, also, window, requested, progress);
    std::vector<std::uint8_t> wanted;
    const bool filled = homogenise(made, *scene.volume, wanted, progress);
    VOXTONE_ENSURE(filled);
    return made;
}

ViewingGrid make_empty_viewing_grid(const Scene& scene, const std::array<int, 3>& view_voxels,
                                    const ColourDepth& colour, std::span<const std::uint8_t> also,
                                    const ViewingWindow& window, const Surface* requested, const Progress* progress) {
    require_resins(scene);
    ViewingGrid made(GridFrame(scene, view_voxels, window));
    made.mixes_core = colour.deeper_in_nodes;
    const BlockContents contents(scene, made, progress);
    GridLister lister(made, *scene.volume, contents, progress);
    lister.list_blocks(blocks_with_cells(scene, made, contents, colour, also, requested, progress));
    lister.list_faces();
    find_face_laws(made, scene, progress);
    return made;
}

}  // namespace voxtone::optics
