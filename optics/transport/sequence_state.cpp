// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/sequence_state.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace voxtone::optics {
namespace {

/// Plain values and lists of them as bytes.
struct StateWriter {
    const AppearanceSequence::StateSink& sink;
    template <class Value>
    void value(const Value& of) const {
        sink(std::as_bytes(std::span(&of, 1)));
    }
    template <class Value>
    void list(const std::vector<Value>& values) const {
        value(std::uint64_t{values.size()});
        sink(std::as_bytes(std::span(values)));
    }
};

/// And back; `good` while the bytes suffice.
struct StateReader {
    std::span<const std::byte> bytes;
    bool good = true;
    void raw(void* to, std::size_t size) {
        good = good && size <= bytes.size();
        if (!good) return;
        if (size > 0) std::memcpy(to, bytes.data(), size);
        bytes = bytes.subspan(size);
    }
    template <class Value>
    void value(Value& of) {
        static_assert(std::is_trivially_copyable_v<Value>);
        raw(&of, sizeof of);
    }
    template <class Value>
    void list(std::vector<Value>& values) {
        std::uint64_t count = 0;
        value(count);
        good = good && count <= bytes.size() / sizeof(Value);
        if (!good) return;
        values.resize(count);
        raw(values.data(), count * sizeof(Value));
    }
};

/// In one order for reading and writing.
template <class Stream, class Field>
void field_in(Stream& stream, Field& field) {
    stream.list(field.blocks);
    stream.list(field.core);
    stream.list(field.out);
}

[[nodiscard]] bool fits(const Tile& tile) {
    std::size_t blocks = 1;
    for (std::size_t a = 0; a < 3; ++a) blocks *= static_cast<std::size_t>(tile.window.end[a] - tile.window.begin[a]);
    return tile.also.empty() || tile.also.size() == blocks;
}

}  // namespace

void write_state(const TileGrids& grids, const GhostLight& ghosts, const AppearanceSequence::StateSink& sink) {
    StateWriter writer{sink};
    writer.value(std::uint64_t{grids.tile_cells()});
    for (const Tile& tile : grids.tiles()) {
        writer.list(tile.also);
        writer.value(tile.trimmed);
        for (std::size_t c = 0; c < tile.light.size(); ++c) {
            if (const ViewingField& field = tile.light[c]; !field.stored) {
                field_in(writer, field);
            } else {
                const ViewingField copy = grids.copy(tile, c);
                field_in(writer, copy);
            }
        }
    }
    writer.value(std::uint64_t{ghosts.size()});
    for (const auto& channel : ghosts) writer.list(channel);
}

bool read_state(TileGrids& grids, GhostLight& ghosts, std::size_t channels, std::span<const std::byte> state) {
    StateReader reader{state};
    std::uint64_t tile_cells = 0;
    reader.value(tile_cells);
    if (tile_cells == 0) return false;
    if (tile_cells != grids.tile_cells()) grids.cut(tile_cells);
    for (Tile& tile : grids.tiles()) {
        reader.list(tile.also);
        reader.value(tile.trimmed);
        for (std::size_t c = 0; c < tile.light.size(); ++c) {
            ViewingField& field = tile.light[c];
            field.stored = false;
            field_in(reader, field);
            grids.put_away(tile, c);
        }
    }
    std::uint64_t count = 0;
    reader.value(count);
    if (!reader.good || (count != 0 && count != channels)) return false;
    ghosts.resize(count);
    for (auto& channel : ghosts) {
        reader.list(channel);
        if (channel.size() != grids.ghosts()) return false;
    }
    // Grids are made anew, with the blocks that these tiles have cells in.
    for (Tile& tile : grids.tiles()) tile.shape.reset();
    return reader.good && reader.bytes.empty() && std::ranges::all_of(grids.tiles(), fits);
}

}  // namespace voxtone::optics
