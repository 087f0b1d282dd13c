// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/mixture_body.h"

#include <algorithm>
#include <cstdint>

#include "base/stopwatch.h"

namespace voxtone::slicer {

class MixtureBody::Rows final : public SlabLayers {
public:
    Rows(const MixtureBody& body, SpanSlab spans) : body_(body), spans_(std::move(spans)) {}
    void push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const override {
        const int width = body_.grid().size[0];
        int i = 0;
        for (const Span& span : spans_.row(j, k)) {
            out.push(static_cast<std::uint32_t>(span.begin - i), io::background);
            body_.fill_.push(span.begin, span.end, j, k, at, out);
            i = span.end;
        }
        out.push(static_cast<std::uint32_t>(width - i), io::background);
    }
    [[nodiscard]] const SpanSlab& spans() const { return spans_; }

private:
    const MixtureBody& body_;
    SpanSlab spans_;
};

LayerCounts MixtureBody::make(int slab, int k_begin, int k_end, const LayerSink& sink) const {
    LayerCounts counts;
    constexpr std::array<int, 3> corner{};
    const auto rows = slab_layers_of(slab, k_begin, k_end, {&corner, 1}, counts);
    const int first = std::max(slab * slab_layers(), k_begin),
              end = std::min({(slab + 1) * slab_layers(), k_end, grid().size[2]});
    Stopwatch watch;
    for (int k = first; k < end; ++k) {
        io::LayerRuns layer(static_cast<std::uint32_t>(grid().size[0]), static_cast<std::uint32_t>(grid().size[1]));
        for (int j = grid().size[1] - 1; j >= 0; --j) {
            rows->push_row(j, k, corner, layer);
            layer.end_row();
        }
        counts.runs_s += watch.lap();
        sink(k, layer);
        watch.lap();
    }
    return counts;
}

std::unique_ptr<const SlabLayers> MixtureBody::slab_layers_of(int slab, int k_begin, int k_end,
                                                              std::span<const std::array<int, 3>>,
                                                              LayerCounts& counts) const {
    const int first = std::max(slab * slab_layers(), k_begin),
              end = std::max(first, std::min({(slab + 1) * slab_layers(), k_end, grid().size[2]}));
    const Stopwatch watch;
    auto rows = std::make_unique<const Rows>(*this, solid_.slab(first, end));
    for (int k = first; k < end; ++k) counts.body_voxels += rows->spans().voxels_of_layer(k);
    counts.solid_s += watch.total();
    return rows;
}

}  // namespace voxtone::slicer
