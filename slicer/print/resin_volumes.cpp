// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/resin_volumes.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "base/random.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/thin_features.h"

namespace voxtone::slicer {

namespace {

constexpr int most_layers = 400;
constexpr std::uint64_t wanted_samples = 25'000;
constexpr std::uint64_t seed = 1;
constexpr std::uint32_t layer_stream = 1, voxel_stream = 2;

/// One layer that stands for `layers` of them.
struct SampledLayer {
    int k = 0, layers = 1;
    SpanSlab spans;
    std::uint64_t voxels = 0;
};

/// A layer of each of up to `most_layers` stretches.
std::vector<SampledLayer> choose_layers(const LayerRange& range) {
    const int n = range.layers(), stretches = std::min(n, most_layers);
    std::vector<SampledLayer> layers(static_cast<std::size_t>(stretches));
    for (int s = 0; s < stretches; ++s) {
        const int low = static_cast<int>(std::int64_t{s} * n / stretches),
                  high = static_cast<int>(std::int64_t{s + 1} * n / stretches);
        RandomStream random(seed, static_cast<std::uint64_t>(s), layer_stream);
        const int chosen = std::min(low + static_cast<int>(random.uniform() * (high - low)), high - 1);
        layers[static_cast<std::size_t>(s)] = {range.first + chosen, high - low, {}, 0};
    }
    return layers;
}

void find_spans(const JobBody& body, bool keep_thin, std::vector<SampledLayer>& layers, const Progress& progress) {
    const Solid solid(*body.solid, body.grid, body.relief);
    std::optional<ThinFeatures> thin;
    if (keep_thin) thin.emplace(body.solid, solid);
    parallel_for(
        0, layers.size(), 1,
        [&](std::size_t s) {
            SampledLayer& layer = layers[s];
            if (thin)
                (void)thin->slab(layer.k, layer.k + 1, layer.spans);
            else
                solid.slab(layer.k, layer.k + 1, layer.spans);
            layer.voxels = layer.spans.voxels_of_layer(layer.k);
        },
        &progress);
}

/// Visits one voxel of each `stride` of the layer's, in the order of its rows, with how many it stands for.
template <class Visit>
void for_each_sample(const SampledLayer& layer, std::uint64_t stride, const Visit& visit) {
    RandomStream random(seed, static_cast<std::uint64_t>(layer.k), voxel_stream);
    std::uint64_t begin = 0, at = 0, passed = 0;  // of the stretch, of its sample; voxels of earlier spans
    const auto choose = [&] {
        const std::uint64_t length = std::min(stride, layer.voxels - begin);
        at = begin + std::min(static_cast<std::uint64_t>(random.uniform() * double(length)), length - 1);
    };
    if (layer.voxels == 0) return;
    choose();
    for (int j = 0; j < layer.spans.rows(); ++j)
        for (const Span& span : layer.spans.row(j, layer.k)) {
            const auto length = static_cast<std::uint64_t>(span.end - span.begin);
            while (begin < layer.voxels && at < passed + length) {
                visit(span.begin + static_cast<int>(at - passed), j, std::min(stride, layer.voxels - begin));
                begin += stride;
                if (begin < layer.voxels) choose();
            }
            passed += length;
        }
}

/// What a layer's samples add up to: voxels by resin, and last those of the shell.
std::vector<double> count_resins(const JobBody& body, const VolumeQuery& query, const SampledLayer& layer,
                                 std::uint64_t stride) {
    const VisibleSurface& surface = *body.surface;
    std::vector<double> voxels(query.resins + 1, 0.0);
    const std::span<double> by_resin(voxels.data(), query.resins);
    std::uint32_t guess = TriangleTree::none;
    for_each_sample(layer, stride, [&](int i, int j, std::uint64_t stands_for) {
        const double weight = double(stands_for) * layer.layers;
        const auto nearest =
            body.surface.tree().nearest(body.grid.centre(i, j, layer.k), guess, query.shell_mm * (1 + 1e-6));
        if (nearest.triangle == TriangleTree::none || nearest.distance > query.shell_mm) {
            by_resin[query.core] += weight;
            return;
        }
        guess = nearest.triangle;
        const auto [a, b, c] = body.surface.tree().corners(nearest.triangle);
        const Eigen::Vector3f weights = nearest_weights(nearest.point, a, b, c).cast<float>();
        const auto& place = surface.source_uv[nearest.triangle];
        const Eigen::Vector2f uv = weights[0] * place[0] + weights[1] * place[1] + weights[2] * place[2];
        query.mixture(surface.source_triangle[nearest.triangle], uv, nearest.distance, weight, by_resin);
        voxels.back() += weight;
    });
    return voxels;
}

}  // namespace

ResinVolumes resin_volumes(const JobBody& body, const VolumeQuery& query, const Progress& progress) {
    std::vector<SampledLayer> layers = choose_layers(query.layers);
    find_spans(body, query.keep_thin, layers, progress);
    std::uint64_t counted = 0;
    double voxels = 0;
    for (const SampledLayer& layer : layers) counted += layer.voxels, voxels += double(layer.voxels) * layer.layers;

    std::vector<double> sum(query.resins + 1, 0.0);
    if (query.mixture && query.shell_mm > 0 && !body.surface->triangles.empty()) {
        const std::uint64_t stride = std::max<std::uint64_t>(1, counted / wanted_samples);
        std::vector<std::vector<double>> of_layer(layers.size());
        parallel_for(
            0, layers.size(), 1, [&](std::size_t s) { of_layer[s] = count_resins(body, query, layers[s], stride); },
            &progress);
        for (const std::vector<double>& part : of_layer)
            for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += part[r];
    } else {
        sum[query.core] = voxels;
    }
    const double ml_per_voxel = body.grid.voxel_volume_mm3() * 1e-3;
    ResinVolumes volumes{voxels * ml_per_voxel, sum.back() * ml_per_voxel, {}};
    for (std::size_t r = 0; r < query.resins; ++r) volumes.ml.push_back(sum[r] * ml_per_voxel);
    return volumes;
}

}  // namespace voxtone::slicer
