// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tiles of a body (viewing_tiles.h) with their grids: made when they are looked at, kept as long as memory allows.
//
// Tiles exchange halos as Schwarz's alternating method does: a block of a tile's own that lies on the rim of another's
// window is a ghost there, and the mean phi of the one becomes the given phi of the other. All rims' places are
// numbered once; each tile knows which of them it receives and which it sends.
//
// A grid whose print got colour deeper than expected is made anew with cells there (`Tile::also`), once without those
// that lost theirs; the light goes over to the new cells. Grids that are dropped for memory are made again with the
// same bits. Memory: about 30 bytes a cell and grid. With a store (list_store.h) grids that are dropped, and all light
// but that of the channel that is worked at, lie there.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "optics/grid/viewing_faces.h"
#include "optics/grid/viewing_grid.h"
#include "optics/grid/viewing_tiles.h"
#include "optics/numerics/list_store.h"
#include "optics/transport/transport_options.h"
#include "optics/transport/viewing_field.h"

namespace voxtone::optics {

/// Light of all channels.
using Fields = std::vector<ViewingField>;

struct Tile : ViewingTile {
    /// What does not change with the resins but for what the cells hold.
    struct Shape {
        const ResinVolume* filled = nullptr;   ///< whose resins the grid has
        bool stored = false, written = false;  ///< the lists are in the store; or are there too
        ViewingGrid grid;
        ViewingFaces seen;
        std::vector<std::uint32_t> received;                        ///< of each of the grid's ghosts: its place
        std::vector<std::pair<std::uint32_t, std::uint32_t>> sent;  ///< own blocks that are others' ghosts, and these
        [[nodiscard]] std::size_t memory_bytes() const;
    };
    std::vector<std::uint8_t> also;  ///< blocks of the window that have had colour deep down
    bool trimmed = false;            ///< of those where it came no more, once
    Fields light;
    std::unique_ptr<Shape> shape;  ///< none where it has to be made
    /// Of the shape that was made last: bytes of it and of the equations, and what a field of it has.
    std::size_t bytes = 0, cells_of_grid = 0, parts = 0, core_nodes = 0, open_faces = 0;
    [[nodiscard]] std::size_t field_bytes() const;  ///< of one channel
};

class TileGrids {
public:
    /// Contract: all of them outlive it.
    TileGrids(const Scene& scene, const Surface& surface, const TransportOptions& options);
    TileGrids(const TileGrids&) = delete;
    TileGrids& operator=(const TileGrids&) = delete;

    /// From now on what is not worked at lies outside of memory where that is short. Throws what
    /// TransportOptions::scratch throws.
    void open_store();
    [[nodiscard]] bool stores() const { return store_.has_value(); }
    /// A tile's light of a channel, in memory.
    ViewingField& bring(Tile& tile, std::size_t channel) const;
    /// To the store, if there is one.
    void put_away(Tile& tile, std::size_t channel);
    /// Left where it is.
    [[nodiscard]] ViewingField copy(const Tile& tile, std::size_t channel) const;

    /// Cuts the body anew into tiles of at most so many surface cells, without light.
    void cut(std::size_t tile_cells);
    [[nodiscard]] std::size_t tile_cells() const { return tile_cells_; }
    [[nodiscard]] std::vector<Tile>& tiles() { return tiles_; }
    [[nodiscard]] const std::vector<Tile>& tiles() const { return tiles_; }
    [[nodiscard]] std::size_t ghosts() const { return ghost_places_.size(); }

    /// Makes the shape of a tile that has none, with room for `besides` bytes.
    void make(Tile& tile, std::size_t besides, const Progress* progress);
    /// Those of all tiles at once, for making one keeps little more than one thread busy; not where they might have to
    /// be dropped before they are used.
    void make_all(const Progress* progress);
    /// Gives a tile's grid the resins of a volume. False where it has to be made anew for that: `also` says with what.
    [[nodiscard]] bool fill(Tile& tile, const ResinVolume& volume, const Progress* progress) const;
    /// Drops shapes of other tiles, the last ones first, until so many bytes more are allowed.
    void make_room(std::size_t bytes, const Tile& kept);

    /// Bytes of the light of all tiles, and of their grids, as the first one's grid has it.
    [[nodiscard]] double expected_light() const;
    [[nodiscard]] double expected_shapes() const;
    [[nodiscard]] std::size_t shape_bytes() const;
    [[nodiscard]] std::size_t field_bytes() const;
    void count(TransportSummary& summary) const;

private:
    [[nodiscard]] std::size_t channels() const { return scene_.resins->channels.size(); }
    [[nodiscard]] double tiles_like_first() const;
    [[nodiscard]] std::size_t place_of_shape(const Tile& tile) const;
    [[nodiscard]] std::size_t place_of(const Tile& tile, std::size_t channel) const;
    void drop(Tile& tile);
    void number_ghosts();
    [[nodiscard]] std::uint32_t ghost_at(const Place& block) const;
    [[nodiscard]] std::unique_ptr<Tile::Shape> shape_of(const Tile& tile, const Progress* progress) const;
    void measure(Tile& tile) const;
    /// Blocks of `also` that have colour in a volume; empty where most of them have.
    [[nodiscard]] std::vector<std::uint8_t> still_coloured(const Tile& tile, const ResinVolume& volume) const;

    const Scene& scene_;
    const Surface& surface_;
    const TransportOptions& options_;
    std::size_t tile_cells_ = 0;
    std::array<int, 3> view_voxels_;
    BlockLattice lattice_;
    std::vector<Tile> tiles_;
    std::optional<ListStore> store_;
    std::vector<std::uint64_t> ghost_places_;  ///< in the lattice of the body, ascending
};

/// Light goes over to a grid with cells in other blocks: that of the cells that both have; where the new one has cells
/// in what was core, the core's.
[[nodiscard]] ViewingField carried_over(const ViewingField& field, const ViewingGrid& was, const ViewingGrid& is);

}  // namespace voxtone::optics
