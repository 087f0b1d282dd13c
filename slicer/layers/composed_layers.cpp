// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/composed_layers.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/stopwatch.h"

namespace voxtone::slicer {

namespace {

/// A part as it stands in one layer of the print.
struct Standing {
    const SlabLayers* layers;
    std::array<int, 3> at;
    int k, width, height;  ///< of the part's own
    bool cuts;
    std::size_t part;
    int priority;

    [[nodiscard]] int left() const { return at[0]; }
    [[nodiscard]] int right() const { return at[0] + width; }
    [[nodiscard]] bool reaches(int j) const { return j >= at[1] && j < at[1] + height; }
    /// Appends row `j`, counted upward in the print, which it reaches.
    void push_row(int j, io::LayerRuns& out) const { layers->push_row(j - at[1], k, at, out); }
};

/// Parts beside each other, from the left: run after run.
void push_beside(std::span<const Standing* const> parts, int j, int width, io::LayerRuns& out) {
    int i = 0;
    for (const Standing* part : parts) {
        out.push(static_cast<std::uint32_t>(part->left() - i), io::background);
        if (part->cuts)
            out.push(static_cast<std::uint32_t>(part->width), io::background);
        else
            part->push_row(j, out);
        i = part->right();
    }
    out.push(static_cast<std::uint32_t>(width - i), io::background);
    out.end_row();
}

/// Parts that may lie over each other, voxel by voxel in the order in which they are laid down.
class Row {
public:
    explicit Row(int width) : material_(static_cast<std::size_t>(width)), owner_(static_cast<std::size_t>(width)) {}

    /// `lost`: by part, voxels that it had and has no more.
    void lay(std::span<const Standing> parts, int j, std::vector<Overlap>& lost) {
        std::fill(material_.begin(), material_.end(), io::background);
        std::fill(owner_.begin(), owner_.end(), nullptr);
        for (const Standing& part : parts) {
            if (!part.reaches(j)) continue;
            io::LayerRuns row(static_cast<std::uint32_t>(part.width), 1);
            part.push_row(j, row);
            row.end_row();
            auto i = static_cast<std::size_t>(part.left());
            for (const io::Run& run : row.row(0)) {
                if (run.material != io::background) take(part, i, i + run.length, run.material, lost);
                i += run.length;
            }
        }
    }
    void push(io::LayerRuns& out) const {
        for (const io::Material material : material_) out.push(1, material);
        out.end_row();
    }

private:
    void take(const Standing& part, std::size_t begin, std::size_t end, std::uint16_t material,
              std::vector<Overlap>& lost) {
        for (std::size_t i = begin; i < end; ++i) {
            if (const Standing* const owner = owner_[i]) {
                Overlap& overlap = lost[owner->part];
                ++overlap.voxels;
                if (owner->priority == part.priority && !part.cuts) ++overlap.to_equals;
            }
            owner_[i] = &part;
            material_[i] = part.cuts ? io::background : static_cast<io::Material>(material);
        }
    }
    std::vector<io::Material> material_;
    std::vector<const Standing*> owner_;  ///< null: nobody
};

/// The slabs that reach the layers [first, last) of the print, each made once for each height its source stands at.
class PartSlabs {
public:
    PartSlabs(const std::vector<PlacedPart>& parts, int first, int last, LayerCounts& counts) {
        for (const PlacedPart& part : parts) {
            const auto [entry, is_new] = made_.try_emplace({part.layers.get(), part.at[2]});
            const int begin = std::max(first - part.at[2], 0),
                      end = std::min(last - part.at[2], part.layers->grid().size[2]);
            if (!is_new || begin >= end) continue;
            const int depth = part.layers->slab_layers();
            for (int slab = begin / depth; slab <= (end - 1) / depth; ++slab)
                entry->second.emplace(slab, part.layers->slab_layers_of(slab, begin, end, counts));
        }
    }
    /// Null where the part has nothing at layer `k` of the print.
    [[nodiscard]] const SlabLayers* at(const PlacedPart& part, int k) const {
        const int own = k - part.at[2];
        if (own < 0 || own >= part.layers->grid().size[2]) return nullptr;
        return made_.at({part.layers.get(), part.at[2]}).at(own / part.layers->slab_layers()).get();
    }

private:
    std::map<std::pair<const LayerSource*, int>, std::map<int, std::unique_ptr<const SlabLayers>>> made_;
};

std::vector<Standing> standing_in(const std::vector<PlacedPart>& parts, std::span<const std::size_t> order,
                                  const PartSlabs& made, int k) {
    std::vector<Standing> standing;
    for (const std::size_t p : order)
        if (const SlabLayers* layers = made.at(parts[p], k)) {
            const auto& size = parts[p].layers->grid().size;
            standing.push_back(
                {layers, parts[p].at, k - parts[p].at[2], size[0], size[1], parts[p].cuts, p, parts[p].priority});
        }
    return standing;
}

/// Those that have voxels or air of their own in row j, from the left; nothing where two of them share columns.
std::optional<std::vector<const Standing*>> beside_each_other(std::span<const Standing> parts, int j) {
    std::vector<const Standing*> here;
    for (const Standing& part : parts)
        if (part.reaches(j)) here.push_back(&part);
    std::ranges::sort(here, {}, [](const Standing* part) { return part->left(); });
    for (std::size_t p = 1; p < here.size(); ++p)
        if (here[p]->left() < here[p - 1]->right()) return std::nullopt;
    return here;
}

void add(const std::vector<Overlap>& from, std::vector<Overlap>& to) {
    for (std::size_t p = 0; p < to.size(); ++p) {
        to[p].voxels += from[p].voxels;
        to[p].to_equals += from[p].to_equals;
    }
}

}  // namespace

ComposedLayers::ComposedLayers(const VoxelGrid& grid, std::vector<PlacedPart> parts)
    : grid_(grid), parts_(std::move(parts)), order_(parts_.size()), lost_(parts_.size()) {
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
    LayerCounts counts;
    if (first >= last) return counts;
    const PartSlabs made(parts_, first, last, counts);
    Stopwatch watch;
    Row overlaid(grid_.size[0]);
    std::vector<Overlap> lost(parts_.size());
    for (int k = first; k < last; ++k) {
        const std::vector<Standing> standing = standing_in(parts_, order_, made, k);
        io::LayerRuns out(static_cast<std::uint32_t>(grid_.size[0]), static_cast<std::uint32_t>(grid_.size[1]));
        for (int j = grid_.size[1] - 1; j >= 0; --j) {
            if (const auto beside = beside_each_other(standing, j)) {
                push_beside(*beside, j, grid_.size[0], out);
            } else {
                overlaid.lay(standing, j, lost);
                overlaid.push(out);
            }
        }
        counts.runs_s += watch.lap();
        sink(k, out);
        watch.lap();
    }
    const std::scoped_lock lock(counting_);
    add(lost, lost_);
    return counts;
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
        LayerCounts counts;
        const PartSlabs made(parts_, first, last, counts);
        std::vector<Overlap> mine(parts_.size());
        Row row(grid_.size[0]);
        for (int k = first; k < last; ++k) {
            const std::vector<Standing> standing = standing_in(parts_, order_, made, k);
            for (int j = 0; j < grid_.size[1]; ++j)
                if (!beside_each_other(standing, j)) row.lay(standing, j, mine);
        }
        const std::scoped_lock lock(mutex);
        add(mine, lost);
    };
    parallel_for(static_cast<std::size_t>(k_begin / slab_layers_),
                 static_cast<std::size_t>((k_end + slab_layers_ - 1) / slab_layers_), 1, count);
    return lost;
}

}  // namespace voxtone::slicer
