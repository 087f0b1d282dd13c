// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_source.h"

#include <algorithm>
#include <vector>

namespace voxtone::slicer {

namespace {

/// Layers as they were made.
class MadeLayers final : public SlabLayers {
public:
    explicit MadeLayers(int first) : first_(first) {}
    void add(const io::LayerRuns& layer) { layers_.push_back(layer); }
    void push_row(int j, int k, const std::array<int, 3>&, io::LayerRuns& out) const override {
        const io::LayerRuns& layer = layers_[static_cast<std::size_t>(k - first_)];
        for (const io::Run& run : layer.row(layer.height_px() - 1 - static_cast<std::uint32_t>(j)))
            out.push(run.length, static_cast<io::Material>(run.material));
    }

    [[nodiscard]] std::size_t memory_bytes() const override {
        std::size_t bytes = 0;
        for (const io::LayerRuns& layer : layers_) bytes += bytes_of_runs(layer);
        return bytes;
    }

private:
    int first_;
    std::vector<io::LayerRuns> layers_;
};

}  // namespace

std::size_t bytes_of_runs(const io::LayerRuns& layer) {
    const std::span<const io::Run> first = layer.row(0), last = layer.row(layer.rows() - 1);
    return static_cast<std::size_t>(last.data() + last.size() - first.data()) * sizeof(io::Run);
}

std::unique_ptr<const SlabLayers> LayerSource::slab_layers_of(int slab, int k_begin, int k_end,
                                                              std::span<const std::array<int, 3>>,
                                                              LayerCounts& counts) const {
    auto made = std::make_unique<MadeLayers>(std::max(k_begin, slab * slab_layers()));
    counts += make(slab, k_begin, k_end, [&](int, const io::LayerRuns& layer) { made->add(layer); });
    return made;
}

}  // namespace voxtone::slicer
