// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/plain_body.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/stopwatch.h"

namespace voxtone::slicer {

class PlainBody::Rows final : public SlabLayers {
public:
    explicit Rows(const PlainBody& body) : body_(body) {}
    void push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const override {
        const int width = body_.grid_.size[0], begin = body_.margin(j), end = width - begin;
        if (begin >= end) return out.push(static_cast<std::uint32_t>(width), io::background);
        out.push(static_cast<std::uint32_t>(begin), io::background);
        body_.fill_.push(begin, end, j, k, at, out);
        out.push(static_cast<std::uint32_t>(begin), io::background);
    }

private:
    const PlainBody& body_;
};

PlainBody::PlainBody(const VoxelGrid& grid, double diameter_mm, const halftone::CumulativeMixture& mixture, int resins,
                     halftone::BlueNoiseScreen screen)
    : grid_(grid), diameter_mm_(diameter_mm), fill_(mixture, resins, std::move(screen)) {}

int PlainBody::margin(int j) const {
    if (diameter_mm_ == 0) return 0;
    const double radius = diameter_mm_ / 2, y = (j + 0.5 - grid_.size[1] / 2.0) * grid_.pitch_mm.y();
    const double squared = radius * radius - y * y;
    if (squared < 0) return grid_.size[0];
    const double first = grid_.size[0] / 2.0 - std::sqrt(squared) / grid_.pitch_mm.x() - 0.5;
    return std::max(0, static_cast<int>(std::ceil(first)));
}

std::uint64_t PlainBody::voxels_of_layer() const {
    std::uint64_t voxels = 0;
    for (int j = 0; j < grid_.size[1]; ++j)
        voxels += static_cast<std::uint64_t>(std::max(0, grid_.size[0] - 2 * margin(j)));
    return voxels;
}

LayerCounts PlainBody::make(int slab, int k_begin, int k_end, const LayerSink& sink) const {
    LayerCounts counts;
    constexpr std::array<int, 3> corner{};
    const auto rows = slab_layers_of(slab, k_begin, k_end, {&corner, 1}, counts);
    Stopwatch watch;
    for (int k = std::max(slab, k_begin); k < std::min({slab + 1, k_end, grid_.size[2]}); ++k) {
        io::LayerRuns layer(static_cast<std::uint32_t>(grid_.size[0]), static_cast<std::uint32_t>(grid_.size[1]));
        for (int j = grid_.size[1] - 1; j >= 0; --j) {
            rows->push_row(j, k, corner, layer);
            layer.end_row();
        }
        counts.runs_s += watch.lap();
        sink(k, layer);
        watch.lap();
    }
    return counts;
}

std::unique_ptr<const SlabLayers> PlainBody::slab_layers_of(int slab, int k_begin, int k_end,
                                                            std::span<const std::array<int, 3>>,
                                                            LayerCounts& counts) const {
    const int layers = std::min({slab + 1, k_end, grid_.size[2]}) - std::max(slab, k_begin);
    if (layers > 0) counts.body_voxels += voxels_of_layer() * static_cast<std::uint64_t>(layers);
    return std::make_unique<const Rows>(*this);
}

halftone::CumulativeMixture cumulative_mixture(std::span<const double> shares) {
    double sum = 0, below = 0;
    for (const double share : shares) {
        VOXTONE_EXPECT(share >= 0);
        sum += share;
    }
    VOXTONE_EXPECT(sum > 0 && shares.size() <= std::size_t{halftone::max_resins});
    halftone::CumulativeMixture mixture;
    mixture.bound.fill(65535);
    for (std::size_t r = 0; r + 1 < shares.size(); ++r) {
        below += shares[r];
        mixture.bound[r] = static_cast<std::uint16_t>(std::min(65535.0, std::round(65536 * below / sum)));
    }
    return mixture;
}

}  // namespace voxtone::slicer
