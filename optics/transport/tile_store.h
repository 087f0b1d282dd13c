// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles that are not worked at, outside of memory: their light, 36 bytes an open face and 8 a cell of each channel, and
// their grids. What is put away keeps its place in the store: put there again it lies over what was there, unless it
// has grown. Same bits as in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/scratch_space.h"
#include "optics/transport/tile_grids.h"

namespace voxtone::optics {

class TileStore {
public:
    explicit TileStore(std::unique_ptr<ScratchSpace> space) : space_(std::move(space)) {}

    /// Writes the lists and frees them. Throws what ScratchSpace::write throws; nothing is freed then.
    void put(std::size_t place, ViewingField& field);
    void put(std::size_t place, Tile::Shape& shape);
    /// Reads them back. Nothing to do where they are in memory.
    void take(std::size_t place, ViewingField& field) const;
    void take(std::size_t place, Tile::Shape& shape) const;
    /// What a field has, wherever that is; the field stays where it is.
    [[nodiscard]] ViewingField copy(std::size_t place, const ViewingField& field) const;
    [[nodiscard]] std::uint64_t bytes() const { return end_; }

private:
    struct Slot {
        std::uint64_t at = 0, room = 0;
        std::vector<std::uint64_t> counts;  ///< of each list
    };
    template <class Lists>
    void write(std::size_t place, Lists& lists);
    template <class Lists>
    void read(std::size_t place, Lists& lists) const;

    std::unique_ptr<ScratchSpace> space_;
    std::vector<Slot> slots_;
    std::uint64_t end_ = 0;
};

}  // namespace voxtone::optics
