// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/lost_contrast.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::halftone {

namespace {

constexpr float middle_loss = 0.03f;     // s
constexpr float least_contrast = 1e-6f;  // keeps ratios finite

float lightness_of(const Eigen::Vector3f& rgb) {
    return static_cast<float>(optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0))[0]);
}

}  // namespace

namespace {

/// S(t^2), S(t p).
std::vector<Eigen::Vector3f> products(std::span<const Eigen::Vector3f> near_target,
                                      std::span<const Eigen::Vector3f> near, const EyeFilter& wide) {
    VOXTONE_EXPECT(near.size() == near_target.size());
    const std::size_t n = near.size();
    std::vector<Eigen::Vector3f> light(n), product(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        light[i] = {lightness_of(near_target[i]), lightness_of(near[i]), 0};
    });
    const std::vector<Eigen::Vector3f> mean = wide.smoothed(light);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        const float t = light[i][0] - mean[i][0], p = light[i][1] - mean[i][1];
        product[i] = {t * t, t * p, 0};
    });
    return wide.smoothed(product);
}

}  // namespace

std::vector<FineContrast> fine_contrast(std::span<const Eigen::Vector3f> near_target,
                                        std::span<const Eigen::Vector3f> near, const EyeFilter& wide) {
    std::vector<FineContrast> contrast;
    for (const Eigen::Vector3f& product : products(near_target, near, wide)) {
        const float wanted = std::sqrt(std::max(product[0], 0.0f));
        contrast.push_back({wanted, wanted > least_contrast ? product[1] / product[0] : 1});
    }
    return contrast;
}

std::vector<float> lost_contrast(std::span<const Eigen::Vector3f> near_target, std::span<const Eigen::Vector3f> near,
                                 const EyeFilter& wide) {
    const std::vector<Eigen::Vector3f> product = products(near_target, near, wide);
    const std::size_t n = product.size();
    std::vector<Eigen::Vector3f> lost(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        const float wanted = std::sqrt(std::max(product[i][0], 0.0f));
        lost[i].setConstant(wanted > least_contrast ? std::max((product[i][0] - product[i][1]) / wanted, 0.0f) : 0);
    });
    lost = wide.smoothed(wide.smoothed(lost));
    std::vector<float> u(n);
    parallel_for(0, n, 1024, [&](std::size_t i) { u[i] = lost[i][0]; });
    return u;
}

std::vector<float> contrast_parts(std::vector<float> lost, float most) {
    VOXTONE_EXPECT(most >= 0 && most <= 1);
    for (float& u : lost) u = most * (u * u / (u * u + middle_loss * middle_loss));
    return lost;
}

}  // namespace voxtone::halftone
