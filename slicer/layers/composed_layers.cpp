// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/composed_layers.h"

#include <algorithm>
#include <map>
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
    const io::LayerRuns* layer;
    int left, bottom;  ///< columns, and rows counted upward, of the print
    bool cuts;
    std::size_t part;

    [[nodiscard]] int right() const { return left + static_cast<int>(layer->width_px()); }
    /// Runs in row `j`, counted upward in the print; empty: none.
    [[nodiscard]] std::span<const io::Run> row(int j) const {
        const int height = static_cast<int>(layer->height_px()), y = height - 1 - (j - bottom);
        if (y < 0 || y >= height) return {};
        return layer->row(static_cast<std::uint32_t>(y));
    }
};

/// Parts beside each other, from the left: run after run.
void push_beside(std::span<const Standing* const> parts, int j, int width, io::LayerRuns& out) {
    int i = 0;
    for (const Standing* part : parts) {
        const std::span<const io::Run> runs = part->row(j);
        if (runs.empty()) continue;
        out.push(static_cast<std::uint32_t>(part->left - i), io::background);
        for (const io::Run& run : runs)
            out.push(run.length, part->cuts ? io::background : static_cast<io::Material>(run.material));
        i = part->right();
    }
    out.push(static_cast<std::uint32_t>(width - i), io::background);
    out.end_row();
}

/// Parts that may lie over each other, voxel by voxel in the order in which they are laid down.
class Row {
public:
    explicit Row(int width) : material_(static_cast<std::size_t>(width)), owner_(static_cast<std::size_t>(width)) {}

    /// `lost`: by part, voxels that it had and has no more. Null: not counted.
    void lay(std::span<const Standing> parts, int j, std::vector<std::uint64_t>* lost) {
        std::fill(material_.begin(), material_.end(), io::background);
        std::fill(owner_.begin(), owner_.end(), nobody);
        for (const Standing& part : parts) {
            auto i = static_cast<std::size_t>(part.left);
            for (const io::Run& run : part.row(j)) {
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
    static constexpr std::uint32_t nobody = ~std::uint32_t{0};
    void take(const Standing& part, std::size_t begin, std::size_t end, std::uint16_t material,
              std::vector<std::uint64_t>* lost) {
        for (std::size_t i = begin; i < end; ++i) {
            if (lost && owner_[i] != nobody) ++(*lost)[owner_[i]];
            owner_[i] = static_cast<std::uint32_t>(part.part);
            material_[i] = part.cuts ? io::background : static_cast<io::Material>(material);
        }
    }
    std::vector<io::Material> material_;
    std::vector<std::uint32_t> owner_;
};

/// The layers [first, last) of the print as the parts have them, each source made once for each height it stands at.
class PartLayers {
public:
    PartLayers(const std::vector<PlacedPart>& parts, int first, int last, LayerCounts& counts) : first_(first) {
        for (const PlacedPart& part : parts) {
            const Key key{part.layers.get(), part.at[2]};
            const auto [entry, is_new] = made_.try_emplace(key);
            if (is_new) make(*part.layers, part.at[2], first, last, entry->second, counts);
        }
    }
    [[nodiscard]] const io::LayerRuns* layer(const PlacedPart& part, int k) const {
        const auto& layers = made_.at({part.layers.get(), part.at[2]});
        const auto& layer = layers[static_cast<std::size_t>(k - first_)];
        return layer ? &*layer : nullptr;
    }

private:
    using Key = std::pair<const LayerSource*, int>;
    using Layers = std::vector<std::optional<io::LayerRuns>>;

    static void make(const LayerSource& source, int bottom, int first, int last, Layers& layers, LayerCounts& counts) {
        layers.resize(static_cast<std::size_t>(last - first));
        const int begin = std::max(first - bottom, 0), end = std::min(last - bottom, source.grid().size[2]);
        if (begin >= end) return;
        const int depth = source.slab_layers();
        for (int slab = begin / depth; slab <= (end - 1) / depth; ++slab)
            counts += source.make(slab, begin, end, [&](int k, const io::LayerRuns& layer) {
                layers[static_cast<std::size_t>(k + bottom - first)].emplace(layer);
            });
    }

    int first_;
    std::map<Key, Layers> made_;
};

std::vector<Standing> standing_in(const std::vector<PlacedPart>& parts, std::span<const std::size_t> order,
                                  const PartLayers& made, int k) {
    std::vector<Standing> standing;
    for (const std::size_t p : order)
        if (const io::LayerRuns* layer = made.layer(parts[p], k))
            standing.push_back({layer, parts[p].at[0], parts[p].at[1], parts[p].cuts, p});
    return standing;
}

/// Those that have voxels or air of their own in row j, from the left; nothing where two of them share columns.
std::optional<std::vector<const Standing*>> beside_each_other(std::span<const Standing> parts, int j) {
    std::vector<const Standing*> here;
    for (const Standing& part : parts)
        if (!part.row(j).empty()) here.push_back(&part);
    std::ranges::sort(here, {}, [](const Standing* part) { return part->left; });
    for (std::size_t p = 1; p < here.size(); ++p)
        if (here[p]->left < here[p - 1]->right()) return std::nullopt;
    return here;
}

}  // namespace

ComposedLayers::ComposedLayers(const VoxelGrid& grid, std::vector<PlacedPart> parts)
    : grid_(grid), parts_(std::move(parts)), order_(parts_.size()) {
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
    const PartLayers made(parts_, first, last, counts);
    Stopwatch watch;
    Row overlaid(grid_.size[0]);
    for (int k = first; k < last; ++k) {
        const std::vector<Standing> standing = standing_in(parts_, order_, made, k);
        io::LayerRuns out(static_cast<std::uint32_t>(grid_.size[0]), static_cast<std::uint32_t>(grid_.size[1]));
        for (int j = grid_.size[1] - 1; j >= 0; --j) {
            if (const auto beside = beside_each_other(standing, j)) {
                push_beside(*beside, j, grid_.size[0], out);
            } else {
                overlaid.lay(standing, j, nullptr);
                overlaid.push(out);
            }
        }
        counts.runs_s += watch.lap();
        sink(k, out);
        watch.lap();
    }
    return counts;
}

std::vector<std::uint64_t> ComposedLayers::overlapped(int k_begin, int k_end) const {
    std::vector<std::uint64_t> lost(parts_.size());
    std::mutex mutex;
    parallel_for(static_cast<std::size_t>(k_begin / slab_layers_),
                 static_cast<std::size_t>((k_end + slab_layers_ - 1) / slab_layers_), 1, [&](std::size_t slab) {
                     const int first = std::max(k_begin, static_cast<int>(slab) * slab_layers_),
                               last = std::min({k_end, (static_cast<int>(slab) + 1) * slab_layers_, grid_.size[2]});
                     LayerCounts counts;
                     const PartLayers made(parts_, first, last, counts);
                     std::vector<std::uint64_t> mine(parts_.size());
                     Row row(grid_.size[0]);
                     for (int k = first; k < last; ++k) {
                         const std::vector<Standing> standing = standing_in(parts_, order_, made, k);
                         for (int j = 0; j < grid_.size[1]; ++j)
                             if (!beside_each_other(standing, j)) row.lay(standing, j, &mine);
                     }
                     const std::scoped_lock lock(mutex);
                     for (std::size_t p = 0; p < lost.size(); ++p) lost[p] += mine[p];
                 });
    return lost;
}

}  // namespace voxtone::slicer
