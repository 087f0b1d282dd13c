// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lists of plain values outside of memory, by numbered places. What is put away again lies over what was there, unless
// it has grown. Of a type of things with lists, `each_list(thing, body)` hands over each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "optics/numerics/scratch_space.h"

namespace voxtone::optics {

class ListStore {
public:
    explicit ListStore(std::unique_ptr<ScratchSpace> space) : space_(std::move(space)) {}
    /// Throws what ScratchSpace::write throws. The lists stay.
    template <class Thing>
    void write(std::size_t place, Thing& thing);
    /// Contract: the like of it was written there.
    template <class Thing>
    void read(std::size_t place, Thing& thing) const;

private:
    struct Place {
        std::uint64_t at = 0, room = 0;
        std::vector<std::uint64_t> counts;  ///< of each list
    };
    template <class List>
    [[nodiscard]] static std::span<std::byte> bytes_of(List& list) {
        static_assert(std::is_trivially_destructible_v<typename List::value_type>);
        return std::as_writable_bytes(std::span(list));
    }

    std::unique_ptr<ScratchSpace> space_;
    std::vector<Place> places_;
    std::uint64_t end_ = 0;
};

template <class Thing>
void ListStore::write(std::size_t place, Thing& thing) {
    if (places_.size() <= place) places_.resize(place + 1);
    Place& slot = places_[place];
    std::uint64_t bytes = 0;
    each_list(thing, [&](auto& list) { bytes += bytes_of(list).size(); });
    if (bytes > slot.room) {
        slot.at = end_;
        slot.room = bytes;
        end_ += bytes;
    }
    slot.counts.clear();
    std::uint64_t at = slot.at;
    each_list(thing, [&](auto& list) {
        space_->write(at, bytes_of(list));
        at += bytes_of(list).size();
        slot.counts.push_back(list.size());
    });
}

template <class Thing>
void ListStore::read(std::size_t place, Thing& thing) const {
    VOXTONE_EXPECT(place < places_.size());
    const Place& slot = places_[place];
    std::uint64_t at = slot.at;
    auto count = slot.counts.begin();
    each_list(thing, [&](auto& list) {
        list.resize(*count++);
        space_->read(at, bytes_of(list));
        at += bytes_of(list).size();
    });
}

}  // namespace voxtone::optics
