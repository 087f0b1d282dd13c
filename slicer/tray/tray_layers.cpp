// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_layers.h"

#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "base/parallel.h"
#include "slicer/prepare/phase.h"

namespace voxtone::slicer {

namespace {

/// Lets in as many threads as memory allows, one at least.
class Room {
public:
    explicit Room(std::uint64_t bytes) : bytes_(bytes) {}

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

}  // namespace

void watch_all(LayerWatchers& watchers, const VoxelGrid& grid, const OpenedJob& job) {
    watchers.thumbnails.emplace(0, grid.size[2], grid, job.palette());
    watchers.voxels.emplace(0, grid.size[2], grid);
}

void make_tray_layers(const ComposedLayers& layers, const LayerRange& range, const LayerTaker& take,
                      LayerWatchers& watchers, Progress& progress) {
    constexpr std::uint64_t bytes_at_once = 1'000'000'000;  // of slabs that are made side by side
    Room room(bytes_at_once);
    const int depth = layers.slab_layers();
    progress.begin_stage(name_of(Phase::layers), std::uint64_t(range.layers()), "layers");
    parallel_for(
        std::size_t(range.first / depth), std::size_t(range.last / depth) + 1, 1,
        [&](std::size_t slab) {
            const auto make = [&] {
                (void)layers.make(int(slab), range.first, range.last + 1, [&](int k, const io::LayerRuns& layer) {
                    progress.check_cancelled();
                    take(k, layer);
                    watchers.take_layer(k, layer);
                    progress.advance();
                });
            };
            room.with([&] { return layers.slab_bytes(); }, make);
        },
        &progress);
    progress.end_stage();
}

}  // namespace voxtone::slicer
