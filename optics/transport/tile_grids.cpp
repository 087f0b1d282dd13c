// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/tile_grids.h"

#include <algorithm>
#include <atomic>
#include <type_traits>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/step_part.h"
#include "optics/grid/homogenisation.h"
#include "optics/grid/refinement.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/transport/viewing_transport.h"

namespace voxtone::optics {
namespace {

constexpr std::uint32_t no_ghost = 0xffffffffu;

/// The open faces of a block, in order: they depend on the shape alone.
template <class Body>
void each_open_face(const ViewingGrid& grid, const GridBlock& block, Body&& body) {
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f)
        if (const std::uint32_t place = grid.place_of_face[f]; !(place & into_core)) body(place);
}

}  // namespace

template <class Body>
void each_list(ViewingField& field, Body&& body) {
    body(field.blocks);
    body(field.core);
    body(field.out);
}

template <class Shape, class Body>
requires std::is_same_v<std::remove_const_t<Shape>, Tile::Shape>
void each_list(Shape& shape, Body&& body) {
    ViewingGrid::each_list(shape.grid, body);
    body(shape.seen.first);
    body(shape.seen.face);
    body(shape.seen.share);
    body(shape.seen.cell);
    body(shape.received);
    body(shape.sent);
}

std::size_t Tile::Shape::memory_bytes() const {
    std::size_t bytes = 0;
    each_list(*this, [&](const auto& list) { bytes += list.capacity() * sizeof(list[0]); });
    return bytes;
}

std::size_t Tile::field_bytes() const {
    return cells_of_grid / 64 * sizeof(ViewingField::BlockCode) + sizeof(ViewingField::FaceCode) * open_faces;
}

TileGrids::TileGrids(const Scene& scene, const Surface& surface, const TransportOptions& options)
    : scene_(scene),
      surface_(surface),
      options_(options),
      view_voxels_(cell_voxels(scene.volume->pitch_mm(), options.cell_mm)),
      lattice_(scene.volume->size(), view_voxels_) {
    cut(options.tile_cells);
}

void TileGrids::open_store() {
    if (!store_) store_.emplace(options_.scratch());
}

/// A tile has one for its grid, and one for each channel's light.
std::size_t TileGrids::place_of_shape(const Tile& tile) const {
    return static_cast<std::size_t>(&tile - tiles_.data()) * (1 + channels());
}

std::size_t TileGrids::place_of(const Tile& tile, std::size_t channel) const {
    return place_of_shape(tile) + 1 + channel;
}

ViewingField& TileGrids::bring(Tile& tile, std::size_t channel) const {
    ViewingField& field = tile.light[channel];
    if (std::exchange(field.stored, false)) store_->read(place_of(tile, channel), field);
    return field;
}

void TileGrids::put_away(Tile& tile, std::size_t channel) {
    ViewingField& field = tile.light[channel];
    if (!store_ || field.stored || field.blocks.empty()) return;
    store_->write(place_of(tile, channel), field);
    field = {};
    field.stored = true;
}

ViewingField TileGrids::copy(const Tile& tile, std::size_t channel) const {
    ViewingField field = tile.light[channel];
    if (std::exchange(field.stored, false)) store_->read(place_of(tile, channel), field);
    return field;
}

void TileGrids::cut(std::size_t tile_cells) {
    tile_cells_ = tile_cells;
    tiles_.clear();
    for (ViewingTile& tile : viewing_tiles(surface_, scene_.volume->size(), scene_.volume->pitch_mm(), view_voxels_,
                                           tile_cells_, options_.tile_halo)) {
        tiles_.emplace_back();
        static_cast<ViewingTile&>(tiles_.back()) = std::move(tile);
        tiles_.back().light.resize(channels());
    }
    number_ghosts();
}

/// All places on the rims of windows, whether the body is there or not.
void TileGrids::number_ghosts() {
    ghost_places_.clear();
    for (const Tile& tile : tiles_)
        for (std::size_t f = 0; f < 6; ++f) {
            if (!tile.window.cut[f]) continue;
            Place first = tile.window.begin, last = tile.window.end;
            first[f / 2] = f % 2 ? last[f / 2] - 1 : first[f / 2];
            last[f / 2] = first[f / 2] + 1;
            for_each({last[0] - first[0], last[1] - first[1], last[2] - first[2]}, [&](const Place& k) {
                ghost_places_.push_back(lattice_.index({first[0] + k[0], first[1] + k[1], first[2] + k[2]}));
            });
        }
    std::sort(ghost_places_.begin(), ghost_places_.end());
    ghost_places_.erase(std::unique(ghost_places_.begin(), ghost_places_.end()), ghost_places_.end());
    ghost_places_.shrink_to_fit();
}

std::uint32_t TileGrids::ghost_at(const Place& block) const {
    const auto found = std::lower_bound(ghost_places_.begin(), ghost_places_.end(), lattice_.index(block));
    return found != ghost_places_.end() && *found == lattice_.index(block)
               ? static_cast<std::uint32_t>(found - ghost_places_.begin())
               : no_ghost;
}

std::unique_ptr<Tile::Shape> TileGrids::shape_of(const Tile& tile, const Progress* progress) const {
    auto shape = std::make_unique<Tile::Shape>();
    ViewingGrid& grid = shape->grid;
    grid = make_empty_viewing_grid(scene_, view_voxels_, {options_.colour_mm, options_.deep_colour_in_nodes}, tile.also,
                                   tile.window, &surface_, progress);
    grid.shrink();
    shape->seen = find_viewing_faces(grid, tiles_.size() == 1 ? surface_ : part_of(surface_, tile.near), progress);
    const auto place_of = [&](std::uint32_t block) {
        Place at = grid.blocks[block].at;
        for (std::size_t a = 0; a < 3; ++a) at[a] += tile.window.begin[a];
        return at;
    };
    for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) {
        const Place at = place_of(b);
        if (!VoxelBox{tile.begin, tile.end}.holds(at)) continue;
        if (const std::uint32_t ghost = ghost_at(at); ghost != no_ghost) shape->sent.emplace_back(b, ghost);
    }
    for (const std::uint32_t ghost : grid.ghosts) shape->received.push_back(ghost_at(place_of(grid.core_block[ghost])));
    return shape;
}

void TileGrids::measure(Tile& tile) const {
    const ViewingGrid& grid = tile.shape->grid;
    const std::array<int, 3> split = parts_of_cell(view_voxels_, scene_.volume->pitch_mm());
    tile.parts = 64 * product(split) * blocks_to_refine(grid, *scene_.volume, options_.refinement).size();
    tile.bytes = tile.shape->memory_bytes() + ViewingTransport::bytes_for(grid, 0) +
                 tile.parts * ViewingTransport::bytes_of_part;
    tile.cells_of_grid = grid.cells();
    tile.core_nodes = grid.core_block.size();
    tile.open_faces = grid.open_faces.size();
}

void TileGrids::make(Tile& tile, std::size_t besides, const Progress* progress) {
    if (tile.shape && !tile.shape->stored) return;
    make_room(tile.bytes + besides, tile);
    if (tile.shape) {
        store_->read(place_of_shape(tile), *tile.shape);
        tile.shape->stored = false;
    } else {
        tile.shape = shape_of(tile, progress);
        measure(tile);
    }
}

void TileGrids::make_all(const Progress* progress) {
    constexpr double slack = 1.3;  // tiles are not alike
    std::vector<Tile*> missing;
    for (Tile& tile : tiles_)
        if (!tile.shape) missing.push_back(&tile);
    if (missing.size() < 2 || store_) return;
    const double all = static_cast<double>(tiles_[0].bytes) * static_cast<double>(tiles_.size()) + expected_light();
    if (options_.memory_bytes > 0 && !(slack * all < static_cast<double>(options_.memory_bytes))) return;
    std::atomic<std::size_t> made{0};
    parallel_for(0, missing.size(), 1, [&](std::size_t i) {
        missing[i]->shape = shape_of(*missing[i], progress);
        tell_part(progress, double(++made) / double(missing.size()));
    });
    for (Tile* const tile : missing) measure(*tile);
}

bool TileGrids::fill(Tile& tile, const ResinVolume& volume, const Progress* progress) const {
    std::vector<std::uint8_t> wanted;
    if (!homogenise(tile.shape->grid, volume, wanted, progress)) {
        tile.also.resize(wanted.size(), 0);
        for (std::size_t i = 0; i < wanted.size(); ++i) tile.also[i] |= wanted[i];
        return false;
    }
    if (tile.trimmed || tile.also.empty()) return true;
    std::vector<std::uint8_t> still = still_coloured(tile, volume);
    if (still.empty()) return true;
    tile.trimmed = true;
    tile.also = std::move(still);
    return false;
}

std::vector<std::uint8_t> TileGrids::still_coloured(const Tile& tile, const ResinVolume& volume) const {
    std::vector<std::uint8_t> still = tile.also;
    const ViewingGrid& grid = tile.shape->grid;
    std::size_t all = 0, left = 0, place = 0;
    for_each(grid.lattice, [&](const Place& at) {
        std::uint8_t& here = still[place++];
        if (!here) return;
        here = volume.uniform_material(grid.corner_of(at), lattice_.block_voxels) < 0;
        ++all;
        left += here;
    });
    // A new grid costs about as much as half of its cells cost in a prediction.
    constexpr std::size_t worth = 16;
    if (worth * (all - left) < grid.transport_blocks.size()) still.clear();
    return still;
}

/// Where there is a store it comes back from there; the resins of a print are filled in anew.
void TileGrids::drop(Tile& tile) {
    if (!store_) {
        tile.shape.reset();
        return;
    }
    Tile::Shape& shape = *tile.shape;
    if (std::exchange(shape.stored, true)) return;
    if (!std::exchange(shape.written, true)) store_->write(place_of_shape(tile), shape);
    each_list(shape, [](auto& list) { list = {}; });
    shape.grid.mixtures = {};
    shape.filled = nullptr;
}

void TileGrids::make_room(std::size_t bytes, const Tile& kept) {
    if (options_.memory_bytes == 0) return;
    std::size_t others = 0;
    for (Tile& tile : tiles_) {
        if (&tile == &kept || !tile.shape) continue;
        others += tile.shape->memory_bytes();
        // The next ones are dropped too: they would not fit either, and the first ones come first again.
        if (bytes + others > options_.memory_bytes) drop(tile);
    }
}

double TileGrids::tiles_like_first() const {
    std::size_t near = 0;
    for (const Tile& tile : tiles_) near += tile.near.size();
    return static_cast<double>(near) / static_cast<double>(tiles_[0].near.size());
}

double TileGrids::expected_light() const {
    return tiles_like_first() * static_cast<double>(channels() * tiles_[0].field_bytes());
}

double TileGrids::expected_shapes() const {
    return tiles_like_first() * static_cast<double>(tiles_[0].shape->memory_bytes());
}

std::size_t TileGrids::shape_bytes() const {
    std::size_t sum = 0;
    for (const Tile& tile : tiles_) sum += tile.shape ? tile.shape->memory_bytes() : 0;
    return sum;
}

std::size_t TileGrids::field_bytes() const {
    std::size_t sum = 0;
    for (const Tile& tile : tiles_)
        for (const ViewingField& field : tile.light) sum += field.memory_bytes();
    return sum;
}

void TileGrids::count(TransportSummary& summary) const {
    summary.pieces = tiles_.size();
    summary.cells = summary.nodes = 0;
    for (const Tile& tile : tiles_) {
        summary.cells += tile.cells_of_grid;
        summary.nodes += tile.cells_of_grid + tile.core_nodes;
    }
}

ViewingField carried_over(const ViewingField& field, const ViewingGrid& was, const ViewingGrid& is) {
    VOXTONE_EXPECT(was.block_at.size() == is.block_at.size());
    if (field.blocks.empty()) return {};
    ViewingField next;
    next.blocks.resize(is.transport_blocks.size());
    next.core.resize(is.core_block.size());
    next.out.resize(is.open_faces.size());
    for (std::size_t place = 0; place < is.block_at.size(); ++place) {
        if (is.block_at[place] < 0) continue;
        const GridBlock &to = is.blocks[static_cast<std::size_t>(is.block_at[place])],
                        &of = was.blocks[static_cast<std::size_t>(was.block_at[place])];
        if (to.kind == BlockKind::core && of.kind == BlockKind::core) {
            next.core[to.core_node] = field.core[of.core_node];
        } else if (to.kind == BlockKind::core) {
            double sum = 0;
            for (const std::uint16_t phi : field.blocks[of.first_cell / 64].phi)
                sum += static_cast<double>(phi_step * static_cast<float>(phi));
            next.core[to.core_node] = static_cast<float>(sum / 64);
        } else if (of.kind == BlockKind::core) {
            const std::uint16_t phi = phi_code(field.core[of.core_node]);
            next.blocks[to.first_cell / 64].phi.fill(phi);
            // Faces to a mirror: what leaves there is as diffuse as the core.
            each_open_face(is, to, [&](std::uint32_t at) { next.out[at] = {phi, phi, {}}; });
        } else {
            next.blocks[to.first_cell / 64] = field.blocks[of.first_cell / 64];
            std::vector<std::uint32_t> from;
            each_open_face(was, of, [&](std::uint32_t at) { from.push_back(at); });
            std::size_t k = 0;
            each_open_face(is, to, [&](std::uint32_t at) { next.out[at] = field.out[from[k++]]; });
        }
    }
    return next;
}

}  // namespace voxtone::optics
