// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/tile_store.h"

#include <span>
#include <type_traits>
#include <utility>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

template <class Body>
void each_list(ViewingField& field, Body&& body) {
    body(field.cells);
    body(field.core);
    body(field.out);
}

/// But for what the resins of a print say, which are filled in anew.
template <class Body>
void each_list(Tile::Shape& shape, Body&& body) {
    ViewingGrid::each_list(shape.grid, body);
    body(shape.seen.first);
    body(shape.seen.face);
    body(shape.seen.share);
    body(shape.seen.cell);
    body(shape.received);
    body(shape.sent);
}

template <class List>
std::span<std::byte> bytes_of(List& list) {
    static_assert(std::is_trivially_destructible_v<typename List::value_type>);
    return std::as_writable_bytes(std::span(list));
}

}  // namespace

template <class Lists>
void TileStore::write(std::size_t place, Lists& lists) {
    if (slots_.size() <= place) slots_.resize(place + 1);
    Slot& slot = slots_[place];
    std::uint64_t bytes = 0;
    each_list(lists, [&](auto& list) { bytes += bytes_of(list).size(); });
    if (bytes > slot.room) {
        slot.at = end_;
        slot.room = bytes;
        end_ += bytes;
    }
    slot.counts.clear();
    std::uint64_t at = slot.at;
    each_list(lists, [&](auto& list) {
        space_->write(at, bytes_of(list));
        at += bytes_of(list).size();
        slot.counts.push_back(list.size());
    });
}

template <class Lists>
void TileStore::read(std::size_t place, Lists& lists) const {
    VOXTONE_EXPECT(place < slots_.size());
    const Slot& slot = slots_[place];
    std::uint64_t at = slot.at;
    auto count = slot.counts.begin();
    each_list(lists, [&](auto& list) {
        list.resize(*count++);
        space_->read(at, bytes_of(list));
        at += bytes_of(list).size();
    });
}

void TileStore::put(std::size_t place, ViewingField& field) {
    if (field.stored || field.cells.empty()) return;
    write(place, field);
    const float scale = field.scale;
    field = {};
    field.scale = scale;
    field.stored = true;
}

void TileStore::take(std::size_t place, ViewingField& field) const {
    if (!std::exchange(field.stored, false)) return;
    read(place, field);
}

ViewingField TileStore::copy(std::size_t place, const ViewingField& field) const {
    ViewingField copy = field;
    take(place, copy);
    return copy;
}

void TileStore::put(std::size_t place, Tile::Shape& shape) {
    if (std::exchange(shape.stored, true)) return;
    if (!shape.written) write(place, shape);
    shape.written = true;
    shape.filled = nullptr;
    each_list(shape, [](auto& list) { list = {}; });
    shape.grid.mixtures = {};
}

void TileStore::take(std::size_t place, Tile::Shape& shape) const {
    if (std::exchange(shape.stored, false)) read(place, shape);
}

}  // namespace voxtone::optics
