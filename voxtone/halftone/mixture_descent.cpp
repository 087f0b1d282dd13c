// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/mixture_descent.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/colour.h"

namespace voxtone::halftone {

namespace {

constexpr double least_light = 1e-4;  // keeps the slope of Oklab finite
constexpr float beta = 0.1f;

Eigen::Vector3f oklab(const Eigen::Vector3f& rgb) { return optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(least_light)).cast<float>(); }

/// d (W^2 r . oklab(p)) / d p, and |W r|^2.
Eigen::Vector3f half_slope(const Eigen::Vector3f& p, const Eigen::Vector3f& residual) {
    const Eigen::Vector3d weighed = Eigen::Vector3d(1, 4, 4).cwiseProduct(residual.cast<double>());
    return (optics::oklab_derivative(p.cast<double>().cwiseMax(least_light)).transpose() * weighed).cast<float>();
}
double square(const Eigen::Vector3f& residual) { return Eigen::Vector3d(1, 4, 4).dot(residual.cast<double>().cwiseAbs2()); }

}  // namespace

MisfitFunction::MisfitFunction(const optics::Surface& surface, const EyeFilter& eye, std::span<const Eigen::Vector3f> target, const EyeFilter* wide,
                               float contrast_part)
    : eye_(eye), wide_(wide), contrast_part_(contrast_part), target_(target), seen_target_(eye.smoothed(target)) {
    double mean = 0;
    for (const optics::SurfaceCell& cell : surface.cells) mean += cell.area_mm2;
    mean /= static_cast<double>(std::max<std::size_t>(1, surface.cells.size()));
    for (const optics::SurfaceCell& cell : surface.cells) area_.push_back(static_cast<float>(cell.area_mm2 / mean));
}

Misfit MisfitFunction::operator()(std::span<const Eigen::Vector3f> predicted) const {
    VOXTONE_EXPECT(predicted.size() == target_.size());
    const std::size_t n = predicted.size();
    const std::vector<Eigen::Vector3f> seen = eye_.smoothed(predicted);
    std::vector<Eigen::Vector3f> far(n), slope(n);
    parallel_for(0, n, 1024, [&](std::size_t i) { far[i] = oklab(seen[i]) - oklab(seen_target_[i]); });
    // d - k S d; in the derivative it stands once more: smoothing averages by area over neighbours, S_ij = w_ij a_j / sum_j w_ij a_j
    // with symmetric w, so where the sums are alike its transpose, with areas on either side, is S again.
    const auto sharpened = [&](std::vector<Eigen::Vector3f>& d) {
        if (!wide_) return;
        const std::vector<Eigen::Vector3f> spread = wide_->smoothed(d);
        for (std::size_t i = 0; i < n; ++i) d[i] -= contrast_part_ * spread[i];
    };
    sharpened(far);
    std::vector<double> part(n);
    std::vector<Eigen::Vector3f> near(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        near[i] = oklab(predicted[i]) - oklab(target_[i]);
        part[i] = static_cast<double>(area_[i]) * (square(far[i]) + static_cast<double>(beta) * square(near[i]));
    });
    Misfit misfit;
    for (const double p : part) misfit.value += p;
    sharpened(far);
    parallel_for(0, n, 1024, [&](std::size_t i) { slope[i] = half_slope(seen[i], far[i]); });
    misfit.by_colour = eye_.smoothed(slope);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        misfit.by_colour[i] = 2 * area_[i] * (misfit.by_colour[i] + beta * half_slope(predicted[i], near[i]));
    });
    return misfit;
}

DescentState begin_descent(SkinMixtures mixtures, const DescentOptions& options) {
    DescentState state;
    state.mixtures = std::move(mixtures);
    state.rate = options.rate;
    state.most_rate = options.most_rate;
    state.momentum.assign(state.mixtures.all().size(), 0.0f);
    state.scale.assign(state.mixtures.cells(), 0.0f);
    const std::size_t resins = state.mixtures.resins();
    parallel_for(0, state.mixtures.cells() * state.mixtures.layers(), 4096, [&](std::size_t i) {
        float* const f = state.mixtures.all().data() + i * resins;
        float sum = 0;
        for (std::size_t r = 0; r < resins; ++r) sum += f[r] = std::max(f[r], least_fraction);
        for (std::size_t r = 0; r < resins; ++r) f[r] /= sum;
    });
    return state;
}

void descend(std::span<const float> gradient, double misfit, const DescentOptions& options, DescentState& state) {
    const std::size_t resins = state.mixtures.resins(), layers = state.mixtures.layers(), cells = state.mixtures.cells();
    VOXTONE_EXPECT(gradient.size() == state.mixtures.all().size());
    // Colours that all cells share, as when light spreads for millimetres, overshoot first: F rises, and the step was too long.
    if (state.misfit > 0 && misfit > state.misfit) {
        state.most_rate = std::min(state.most_rate, options.ceiling * state.rate);
        state.rate *= options.slower;
        for (float& m : state.momentum) m *= options.forget;
    } else if (state.misfit > 0) {
        state.rate = std::min(state.rate * options.faster, state.most_rate);
    }
    state.misfit = misfit;
    const auto mean_of = [&](std::size_t c, std::size_t l) {
        const float* const f = state.mixtures.cell(c).data() + l * resins;
        const float* const g = gradient.data() + (c * layers + l) * resins;
        float mean = 0;
        for (std::size_t r = 0; r < resins; ++r) mean += f[r] * g[r];
        return mean;
    };
    parallel_for(0, cells, 512, [&](std::size_t c) {
        float largest = 0;
        for (std::size_t l = 0; l < layers; ++l) {
            const float mean = mean_of(c, l);
            for (std::size_t r = 0; r < resins; ++r) {
                const std::size_t at = l * resins + r;
                largest = std::max(largest, std::abs(gradient[c * layers * resins + at] - mean) * std::sqrt(state.mixtures.cell(c)[at]));
            }
        }
        state.scale[c] = std::max(0.9f * state.scale[c], largest);
    });
    double sum = 0;
    for (const float s : state.scale) sum += s;
    const float shared = options.shared * static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(1, cells)));
    parallel_for(0, cells, 512, [&](std::size_t c) {
        const float s = state.scale[c] + shared;
        if (!(s > 0)) return;
        for (std::size_t l = 0; l < layers; ++l) {
            const float mean = mean_of(c, l);
            float* const f = state.mixtures.cell(c).data() + l * resins;
            float total = 0;
            for (std::size_t r = 0; r < resins; ++r) {
                const std::size_t at = (c * layers + l) * resins + r;
                float& m = state.momentum[at];
                m = options.momentum * m + (1 - options.momentum) * (gradient[at] - mean);
                f[r] = std::clamp(f[r] * std::exp(std::clamp(-state.rate * m / s, -1.0f, 1.0f)), least_fraction, 1.0f);
                total += f[r];
            }
            for (std::size_t r = 0; r < resins; ++r) f[r] /= total;
        }
    });
}

SkinMixtures printed(const SkinMixtures& mixtures) {
    SkinMixtures out = mixtures;
    for (float& f : out.all())
        if (f < 3 * least_fraction) f = 0;
    return out;
}

}  // namespace voxtone::halftone
