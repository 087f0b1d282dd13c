// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace voxtone::slicer {

/// Lets in as many threads as memory allows, one at least.
class MemoryRoom {
public:
    explicit MemoryRoom(std::uint64_t bytes) : bytes_(bytes) {}

    /// `needed`: bytes, as is known at the time.
    template <class Needed, class Work>
    void with(const Needed& needed, const Work& work) {
        std::uint64_t mine = 0;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] {
                mine = needed();
                return taken_ == 0 || taken_ + mine <= bytes_;
            });
            taken_ += mine;
        }
        const auto leave = [&] {
            const std::scoped_lock lock(mutex_);
            taken_ -= mine;
            changed_.notify_all();
        };
        try {
            work();
        } catch (...) {
            leave();
            throw;
        }
        leave();
    }

private:
    std::uint64_t bytes_, taken_ = 0;
    std::mutex mutex_;
    std::condition_variable changed_;
};

}  // namespace voxtone::slicer
