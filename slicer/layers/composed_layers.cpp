// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/composed_layers.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/stopwatch.h"

namespace voxtone::slicer {

namespace {

/// The slabs that reach the layers [first, last) of the print, each made once for each height its source stands at.
class PartSlabs {
public:
    /// `counts`: of each part.
    PartSlabs(const std::vector<PlacedPart>& parts, int first, int last, std::vector<LayerCounts>& counts) {
        struct Group {
            std::size_t first_part;
            std::vector<std::array<int, 3>> places;
        };
        std::map<Key, Group> all;
        for (std::size_t p = 0; p < parts.size(); ++p)
            all.try_emplace(key_of(parts[p]), Group{p, {}}).first->second.places.push_back(parts[p].at);
        for (const auto& [key, standing] : all) {
            const auto& [layers, bottom] = key;
            std::map<int, std::unique_ptr<const SlabLayers>>& slabs = made_[key];
            const int begin = std::max(first - bottom, 0), end = std::min(last - bottom, layers->grid().size[2]);
            if (begin >= end) continue;
            const int depth = layers->slab_layers();
            for (int slab = begin / depth; slab <= (end - 1) / depth; ++slab) {
                const auto& made = slabs.emplace(
                    slab, layers->slab_layers_of(slab, begin, end, standing.places, counts[standing.first_part]));
                bytes_ += made.first->second->memory_bytes();
            }
        }
    }
    /// Null where the part has nothing at layer `k` of the print.
    [[nodiscard]] const SlabLayers* at(const PlacedPart& part, int k) const {
        const int own = k - part.at[2];
        if (own < 0 || own >= part.layers->grid().size[2]) return nullptr;
        return made_.at(key_of(part)).at(own / part.layers->slab_layers()).get();
    }
    [[nodiscard]] std::uint64_t memory_bytes() const { return bytes_; }

private:
    using Key = std::pair<const LayerSource*, int>;
    static Key key_of(const PlacedPart& part) { return {part.layers.get(), part.at[2]}; }
    std::map<Key, std::map<int, std::unique_ptr<const SlabLayers>>> made_;
    std::uint64_t bytes_ = 0;
};

std::vector<PartInLayer> standing_in(const std::vector<PlacedPart>& parts, std::span<const std::size_t> order,
                                     const PartSlabs& made, int k) {
    std::vector<PartInLayer> standing;
    for (const std::size_t p : order)
        if (const SlabLayers* layers = made.at(parts[p], k)) {
            const auto& size = parts[p].layers->grid().size;
            standing.push_back(
                {layers, parts[p].at, k - parts[p].at[2], size[0], size[1], parts[p].cuts, p, parts[p].priority});
        }
    return standing;
}

/// Makes the layers of parts that somebody looks at, once for him and for the print.
std::vector<std::unique_ptr<const io::LayerRuns>> show(std::span<PartInLayer> standing,
                                                       const std::vector<PlacedPart>& parts,
                                                       std::vector<LayerCounts>& counts) {
    std::vector<std::unique_ptr<const io::LayerRuns>> shown;
    for (PartInLayer& one : standing) {
        if (!parts[one.part].seen) continue;
        const Stopwatch watch;
        shown.push_back(std::make_unique<const io::LayerRuns>(one.layer()));
        counts[one.part].runs_s += watch.total();
        one.shown = shown.back().get();
        parts[one.part].seen(one.k, *one.shown);
    }
    return shown;
}

void add(const std::vector<Overlap>& from, std::vector<Overlap>& to) {
    for (std::size_t p = 0; p < to.size(); ++p) {
        to[p].voxels += from[p].voxels;
        to[p].to_equals += from[p].to_equals;
    }
}

}  // namespace

ComposedLayers::ComposedLayers(const VoxelGrid& grid, std::vector<PlacedPart> parts)
    : grid_(grid), parts_(std::move(parts)), order_(parts_.size()), lost_(parts_.size()), counts_(parts_.size()) {
    VOXTONE_EXPECT(!parts_.empty());
    slab_layers_ = 1;
    for (const PlacedPart& part : parts_) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            VOXTONE_EXPECT(part.at[axis] >= 0 && part.at[axis] + part.layers->grid().size[axis] <= grid_.size[axis]);
        slab_layers_ = std::max(slab_layers_, part.layers->slab_layers());
    }
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::stable_sort(order_, {}, [&](std::size_t p) { return parts_[p].priority; });
}

LayerCounts ComposedLayers::make(int slab, int k_begin, int k_end, const LayerSink& sink) const {
    const int first = std::max(k_begin, slab * slab_layers_),
              last = std::min({k_end, (slab + 1) * slab_layers_, grid_.size[2]});
    if (first >= last) return {};
    std::vector<LayerCounts> counts(parts_.size());
    const PartSlabs made(parts_, first, last, counts);
    io::LayerRuns out(static_cast<std::uint32_t>(grid_.size[0]), static_cast<std::uint32_t>(grid_.size[1]));
    std::uint64_t runs_bytes = 0;
    LayerCounts all;
    Stopwatch watch;
    OverlaidRow overlaid(grid_.size[0]);
    std::vector<Overlap> lost(parts_.size());
    for (int k = first; k < last; ++k) {
        std::vector<PartInLayer> standing = standing_in(parts_, order_, made, k);
        watch.lap();
        const std::vector<std::unique_ptr<const io::LayerRuns>> shown = show(standing, parts_, counts);
        watch.lap();
        if (standing.size() == 1 && standing[0].shown && standing[0].fills(grid_)) {
            sink(k, *standing[0].shown);
            continue;
        }
        out.clear();
        PartRows parts(standing, grid_.size[0]);
        for (int j = grid_.size[1] - 1; j >= 0; --j) {
            if (parts.are_apart(j)) {
                parts.push(j, out);
            } else {
                overlaid.lay(standing, j, lost);
                overlaid.push(out);
            }
        }
        runs_bytes = std::max(runs_bytes, bytes_of_runs(out));
        all.runs_s += watch.lap();
        sink(k, out);
    }
    for (const LayerCounts& part : counts) all += part;
    const std::scoped_lock lock(counting_);
    add(lost, lost_);
    for (std::size_t p = 0; p < counts.size(); ++p) counts_[p] += counts[p];
    slab_bytes_ = std::max(slab_bytes_, std::max<std::uint64_t>(1, made.memory_bytes() + runs_bytes));
    return all;
}

std::uint64_t ComposedLayers::slab_bytes() const {
    {
        const std::scoped_lock lock(counting_);
        if (slab_bytes_ > 0) return slab_bytes_;
    }
    // A voxel of a part is kept as a byte for each of few places or as its mixture for many (screened_slab.h), one of a
    // layer as a run; a list that grows is there twice.
    constexpr std::uint64_t most_a_voxel = 14, grown = 2;
    std::map<std::pair<const LayerSource*, int>, std::uint64_t> places;
    for (const PlacedPart& part : parts_) ++places[{part.layers.get(), part.at[2]}];
    const auto square = [](const VoxelGrid& grid) { return std::uint64_t(grid.size[0]) * std::uint64_t(grid.size[1]); };
    std::uint64_t bytes = grown * sizeof(io::Run) * square(grid_);
    for (const auto& [source, count] : places)
        bytes += grown * std::min(most_a_voxel, count) * square(source.first->grid()) * std::uint64_t(slab_layers_);
    return bytes;
}

std::vector<LayerCounts> ComposedLayers::counted() const {
    const std::scoped_lock lock(counting_);
    return counts_;
}

std::vector<Overlap> ComposedLayers::overlapped() const {
    const std::scoped_lock lock(counting_);
    return lost_;
}

bool ComposedLayers::boxes_overlap(int first, int last) const {
    const auto low = [&](const PlacedPart& part, std::size_t axis) {
        return axis == 2 ? std::max(part.at[2], first) : part.at[axis];
    };
    const auto high = [&](const PlacedPart& part, std::size_t axis) {
        const int end = part.at[axis] + part.layers->grid().size[axis];
        return axis == 2 ? std::min(end, last) : end;
    };
    for (std::size_t a = 0; a < parts_.size(); ++a)
        for (std::size_t b = a + 1; b < parts_.size(); ++b) {
            bool overlap = true;
            for (std::size_t axis = 0; axis < 3; ++axis)
                overlap = overlap && std::max(low(parts_[a], axis), low(parts_[b], axis)) <
                                         std::min(high(parts_[a], axis), high(parts_[b], axis));
            if (overlap) return true;
        }
    return false;
}

std::vector<Overlap> ComposedLayers::overlapped(int k_begin, int k_end) const {
    std::vector<Overlap> lost(parts_.size());
    std::mutex mutex;
    const auto count = [&](std::size_t slab) {
        const int first = std::max(k_begin, static_cast<int>(slab) * slab_layers_),
                  last = std::min({k_end, (static_cast<int>(slab) + 1) * slab_layers_, grid_.size[2]});
        if (!boxes_overlap(first, last)) return;
        std::vector<LayerCounts> counts(parts_.size());
        const PartSlabs made(parts_, first, last, counts);
        std::vector<Overlap> mine(parts_.size());
        OverlaidRow row(grid_.size[0]);
        for (int k = first; k < last; ++k) {
            const std::vector<PartInLayer> standing = standing_in(parts_, order_, made, k);
            PartRows parts(standing, grid_.size[0]);
            for (int j = 0; j < grid_.size[1]; ++j)
                if (!parts.are_apart(j)) row.lay(standing, j, mine);
        }
        const std::scoped_lock lock(mutex);
        add(mine, lost);
    };
    parallel_for(static_cast<std::size_t>(k_begin / slab_layers_),
                 static_cast<std::size_t>((k_end + slab_layers_ - 1) / slab_layers_), 1, count);
    return lost;
}

}  // namespace voxtone::slicer
