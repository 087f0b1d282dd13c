// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/surface_mixtures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::optics {

namespace {

constexpr double seen_sigma_mm = 0.12;
constexpr double seen_reach_mm = 2.2 * seen_sigma_mm;  // 97 % of the light along each axis

// Weights of the voxels along one axis about a place; the first of them is voxel `first`.
struct AxisWeights {
    int first = 0;
    std::vector<float> weight;
};

AxisWeights axis_weights(double place_mm, double pitch_mm) {
    const int first = static_cast<int>(std::floor((place_mm - seen_reach_mm) / pitch_mm));
    const int last = static_cast<int>(std::floor((place_mm + seen_reach_mm) / pitch_mm));
    AxisWeights axis{first, {}};
    for (int k = first; k <= last; ++k) {
        const double away = ((k + 0.5) * pitch_mm - place_mm) / seen_sigma_mm;
        axis.weight.push_back(static_cast<float>(std::exp(-0.5 * away * away)));
    }
    return axis;
}

void add_box(const ResinVolume& volume, const std::array<float, 3>& place_mm, std::vector<Material>& box,
             std::span<float> shares) {
    std::array<AxisWeights, 3> axes;
    std::array<int, 3> corner{}, extent{};
    for (std::size_t a = 0; a < 3; ++a) {
        axes[a] = axis_weights(static_cast<double>(place_mm[a]), volume.pitch_mm()[a]);
        corner[a] = axes[a].first, extent[a] = static_cast<int>(axes[a].weight.size());
    }
    box.resize(axes[0].weight.size() * axes[1].weight.size() * axes[2].weight.size());
    volume.copy_box(corner, extent, box);
    std::size_t at = 0;
    for (const float z : axes[2].weight)
        for (const float y : axes[1].weight)
            for (const float x : axes[0].weight) {
                const Material material = box[at++];
                if (material != air) shares[material - 1u] += x * y * z;
            }
}

}  // namespace

void mixture_at(const ResinVolume& volume, const std::array<float, 3>& place_mm, std::span<float> shares) {
    std::vector<Material> box;
    std::ranges::fill(shares, 0.0f);
    add_box(volume, place_mm, box, shares);
    float sum = 0;
    for (const float share : shares) sum += share;
    for (float& share : shares) share = sum > 0 ? share / sum : 0;
}

std::vector<float> surface_mixtures(const ResinVolume& volume, const Surface& surface, std::size_t resins,
                                    const Progress* progress) {
    std::vector<float> mixtures(surface.cells.size() * resins, 0.0f);
    parallel_ranges(
        0, surface.cells.size(), 256,
        [&](std::size_t first, std::size_t last) {
            std::vector<Material> box;
            for (std::size_t i = first; i < last; ++i) {
                const std::span<float> shares(mixtures.data() + i * resins, resins);
                add_box(volume, surface.cells[i].centre_mm, box, shares);
                float sum = 0;
                for (const float share : shares) sum += share;
                VOXTONE_EXPECT(sum > 0);
                for (float& share : shares) share /= sum;
            }
        },
        progress);
    return mixtures;
}

}  // namespace voxtone::optics
