// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/lateral_transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/contracts.h"
#include "base/parallel.h"

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

using Smoothings = std::array<std::unique_ptr<SurfaceSmoothing>, profile_gaussians>;

Smoothings smoothings_of(std::span<const SurfacePoint> points) {
    const double edge_mm = typical_edge_mm(points);
    Smoothings all;
    parallel_for(0, all.size(), 1, [&](std::size_t j) {
        all[j] = std::make_unique<SurfaceSmoothing>(points, spread_between_cells(gaussian_widths_mm()[j], edge_mm), 0,
                                                    edge_mm);
    });
    return all;
}

// R of a few channels, interleaved.
class Exchange {
public:
    Exchange(const Smoothings& smoothings, std::span<const GaussianWeights> weights, std::size_t channels,
             std::size_t first, std::size_t count)
        : smoothings_(smoothings), count_(count), total_(weights.size() / channels * count) {
        for (std::vector<float>& root : root_) root.resize(total_.size());
        parallel_for(0, weights.size() / channels, 4096, [&](std::size_t i) {
            for (std::size_t c = 0; c < count; ++c) {
                const GaussianWeights& w = weights[i * channels + first + c];
                for (std::size_t j = 0; j < w.size(); ++j) {
                    root_[j][i * count + c] = std::sqrt(w[j]);
                    total_[i * count + c] += w[j];
                }
            }
        });
    }
    [[nodiscard]] const std::vector<float>& total() const { return total_; }
    void apply(const std::vector<float>& down, std::vector<float>& up) const {
        std::vector<float> in(down.size()), out(down.size());
        up.assign(down.size(), 0);
        for (std::size_t j = 0; j < profile_gaussians; ++j) {
            parallel_for(0, down.size(), 4096, [&](std::size_t i) { in[i] = root_[j][i] * down[i]; });
            smoothings_[j]->apply(in, out, count_);
            parallel_for(0, down.size(), 4096, [&](std::size_t i) { up[i] += root_[j][i] * out[i]; });
        }
    }

private:
    const Smoothings& smoothings_;
    std::size_t count_;
    std::vector<float> total_;
    std::array<std::vector<float>, profile_gaussians> root_;
};

// d = 1 + s R d. The values of 1 - s R lie between 1 - s and 1 (Y. Saad, Iterative Methods for Sparse Linear Systems,
// 2nd ed., Alg. 12.1).
std::vector<float> light_down(const Exchange& exchange, float s) {
    constexpr int steps = 4;
    const std::vector<float>& total = exchange.total();
    const std::size_t n = total.size();
    std::vector<float> d(n), up, rest(n), step(n);
    parallel_for(0, n, 4096, [&](std::size_t i) { d[i] = 1 / (1 - s * total[i]); });
    if (s == 0) return d;
    exchange.apply(d, up);
    const float middle = 1 - 0.5F * s, half = 0.5F * s, sigma = middle / half;
    parallel_for(0, n, 4096, [&](std::size_t i) {
        rest[i] = 1 + s * up[i] - d[i];
        step[i] = rest[i] / middle;
    });
    float rho = 1 / sigma;
    for (int k = 0; k < steps; ++k) {
        exchange.apply(step, up);
        const float next = 1 / (2 * sigma - rho);
        parallel_for(0, n, 4096, [&](std::size_t i) {
            d[i] += step[i];
            rest[i] -= step[i] - s * up[i];
            step[i] = next * rho * step[i] + 2 * next / half * rest[i];
        });
        rho = next;
    }
    parallel_for(0, n, 4096, [&](std::size_t i) { d[i] += step[i]; });
    return d;
}

}  // namespace

std::vector<float> with_lateral_transport(std::span<const SurfacePoint> points,
                                          std::span<const GaussianWeights> weights, std::size_t channels,
                                          double turned_back) {
    VOXTONE_EXPECT(weights.size() == points.size() * channels && turned_back >= 0 && turned_back < 1);
    std::vector<float> seen(weights.size());
    if (points.empty()) return seen;
    const auto s = static_cast<float>(turned_back);
    const Smoothings smoothings = smoothings_of(points);
    for (std::size_t c = 0; c < channels;) {
        const std::size_t together = channels - c >= 3 ? 3 : 1;  // what a smoothing takes
        const Exchange exchange(smoothings, weights, channels, c, together);
        std::vector<float> up = light_down(exchange, s);
        if (s == 0)
            exchange.apply(std::vector<float>(up.size(), 1), up);
        else
            for (float& value : up) value = (value - 1) / s;
        parallel_for(0, points.size(), 4096, [&](std::size_t i) {
            for (std::size_t k = 0; k < together; ++k)
                seen[i * channels + c + k] = std::clamp((1 - s) * up[i * together + k], 0.0F, 1.0F);
        });
        c += together;
    }
    return seen;
}

}  // namespace voxtone::optics
