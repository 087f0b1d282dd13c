// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/sideways_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"

namespace voxtone::optics {
namespace {

// Between cells of edge p: see the header.
double spread_between_cells(double u, double p) {
    constexpr double sqrt_pi = 1 / std::numbers::inv_sqrtpi;
    if (u > p / sqrt_pi) return std::sqrt(u * u + p * p / 3);
    // Share that goes to one neighbour, and the Gaussian that gives it as much.
    const double share = u / (2 * sqrt_pi * p);
    return p / std::sqrt(-std::log(share / (1 - 2 * share)));
}

}  // namespace

std::vector<float> with_sideways_light(std::span<const SurfacePoint> points, std::span<const GaussianWeights> weights,
                                       std::size_t channels) {
    VOXTONE_EXPECT(weights.size() == points.size() * channels);
    std::vector<float> seen(weights.size());
    if (points.empty()) return seen;
    const double edge_mm = typical_edge_mm(points);
    std::vector<float> root, smooth;
    for (std::size_t j = 0; j < profile_gaussians; ++j) {
        const SurfaceSmoothing smoothing(points, spread_between_cells(gaussian_widths_mm()[j], edge_mm), 0, edge_mm);
        for (std::size_t c = 0; c < channels;) {
            const std::size_t together = channels - c >= 3 ? 3 : 1;  // what it takes
            root.resize(points.size() * together);
            smooth.resize(root.size());
            parallel_for(0, points.size(), 4096, [&](std::size_t i) {
                for (std::size_t k = 0; k < together; ++k)
                    root[i * together + k] = std::sqrt(weights[i * channels + c + k][j]);
            });
            smoothing.apply(root, smooth, together);
            parallel_for(0, points.size(), 4096, [&](std::size_t i) {
                for (std::size_t k = 0; k < together; ++k)
                    seen[i * channels + c + k] += root[i * together + k] * smooth[i * together + k];
            });
            c += together;
        }
    }
    for (float& value : seen) value = std::min(value, 1.0F);
    return seen;
}

}  // namespace voxtone::optics
