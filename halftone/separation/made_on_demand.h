// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which entries of a table stand already, where each is made when it is first asked for, from any thread. What an entry
// holds may not depend on who asks and when: then the table is the same for any number of threads.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace voxtone::halftone {

class MadeOnDemand {
public:
    explicit MadeOnDemand(std::size_t entries) : made_(entries) {}

    /// What was written before the entry was marked may be read.
    [[nodiscard]] bool made(std::size_t entry) const { return made_[entry].load(std::memory_order_acquire) != 0; }
    void mark(std::size_t entry) { made_[entry].store(1, std::memory_order_release); }

    /// Calls `make`, which marks the entry, unless it stands; one call at a time within a group of entries. `make` may
    /// ask for entries of another table, but not start a parallel loop: its thread could be given work that waits here.
    template <class Make>
    void require(std::size_t entry, std::size_t group, Make&& make) {
        if (made(entry)) return;
        const std::scoped_lock lock(mutex_[group % mutex_.size()]);
        if (!made(entry)) make();
    }

private:
    std::vector<std::atomic<std::uint8_t>> made_;
    std::array<std::mutex, 64> mutex_;
};

}  // namespace voxtone::halftone
