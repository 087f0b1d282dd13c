// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/gaussian_profile.h"

#include <cmath>

#include <Eigen/LU>

namespace voxtone::optics {
namespace {

constexpr int lobes = profile_gaussians;
constexpr double narrowest_mm = 0.05, widest_mm = 5;
constexpr double longest_wave = 0.25, shortest_wave = 40;  // rad/mm
constexpr double smoothness = 5e-4;
constexpr int sweeps = 24;

using Weights = Eigen::Matrix<float, lobes, 1>;

struct Fit {
    Eigen::Matrix<float, lobes, profile_waves> right_side;
    Eigen::Matrix<float, lobes, lobes> normal, inverse;
};

const Fit& fit() {
    static const Fit made = [] {
        Eigen::Matrix<double, profile_waves, lobes> transform;
        for (int i = 0; i < profile_waves; ++i)
            for (int j = 0; j < lobes; ++j) {
                const double phase =
                    0.5 * static_cast<double>(wave_numbers()[i]) * gaussian_widths_mm()[static_cast<std::size_t>(j)];
                transform(i, j) = std::exp(-phase * phase);
            }
        // Third differences; nothing lies beyond the ends.
        Eigen::Matrix<double, lobes + 3, lobes> rough = Eigen::Matrix<double, lobes + 3, lobes>::Zero();
        for (int j = 0; j < lobes; ++j)
            rough(j, j) = 1, rough(j + 1, j) = -3, rough(j + 2, j) = 3, rough(j + 3, j) = -1;
        const Eigen::Matrix<double, lobes, lobes> normal =
            transform.transpose() * transform + smoothness * rough.transpose() * rough;
        return Fit{transform.transpose().cast<float>(), normal.cast<float>(), normal.inverse().cast<float>()};
    }();
    return made;
}

}  // namespace

const std::array<double, profile_gaussians>& gaussian_widths_mm() {
    static const std::array<double, profile_gaussians> widths = [] {
        std::array<double, profile_gaussians> u{};
        for (std::size_t j = 0; j < u.size(); ++j)
            u[j] = narrowest_mm * std::pow(widest_mm / narrowest_mm, static_cast<double>(j) / (u.size() - 1.0));
        return u;
    }();
    return widths;
}

const Waves& wave_numbers() {
    static const Waves waves = [] {
        Waves kappa;
        kappa[0] = 0;
        for (int i = 1; i < profile_waves; ++i)
            kappa[i] = static_cast<float>(longest_wave *
                                          std::pow(shortest_wave / longest_wave, (i - 1.0) / (profile_waves - 2.0)));
        return kappa;
    }();
    return waves;
}

GaussianWeights gaussian_weights(const Waves& profile) {
    const Fit& by = fit();
    const float total = profile[0];
    GaussianWeights weights{};
    if (!(total > 0)) return weights;
    // Minimum of the quadratic form among w >= 0: from the free one on, one weight at a time.
    const Weights b = by.right_side * (profile / total).matrix();
    Weights w = (by.inverse * b).cwiseMax(0);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (int j = 0; j < lobes; ++j)
            w[j] = std::max(0.0F, w[j] + (b[j] - by.normal.col(j).dot(w)) / by.normal(j, j));
    const float scale = total / w.sum();
    for (int j = 0; j < lobes; ++j) weights[static_cast<std::size_t>(j)] = scale * w[j];
    return weights;
}

}  // namespace voxtone::optics
