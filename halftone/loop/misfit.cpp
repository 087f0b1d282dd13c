// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/misfit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::halftone {

namespace {

constexpr double least_light = 1e-4;  // keeps the slope of Oklab finite
constexpr float gamma = 2, beta = 0.03f;
constexpr double soft = 0.08;  // s

Eigen::Vector3d lit(const Eigen::Vector3f& rgb) { return rgb.cast<double>().cwiseMax(least_light); }
Eigen::Vector3f oklab_of(const Eigen::Vector3f& rgb) { return optics::oklab_from_linear_srgb(lit(rgb)).cast<float>(); }

/// rho(|W r|), and its derivative by r.
struct Part {
    double value = 0;
    Eigen::Vector3f by_residual;
};
Part part_of(const Eigen::Vector3f& residual) {
    const Eigen::Vector3d r = residual.cast<double>(), weighed = Eigen::Vector3d(1, 4, 4).cwiseProduct(r);
    const double length = std::sqrt(weighed.dot(r) + soft * soft);
    return {length - soft, (weighed / length).cast<float>()};
}

/// d (by_oklab . oklab_of(p)) / d p.
Eigen::Vector3f by_light(const Eigen::Vector3f& p, const Eigen::Vector3f& by_oklab) {
    return (optics::oklab_derivative(lit(p)).transpose() * by_oklab.cast<double>()).cast<float>();
}

Eigen::Vector3d light_of_lab(const Eigen::Vector3f& lab) {
    return optics::linear_srgb_from_lab(lab.cast<double>()).cwiseMax(least_light);
}
Eigen::Vector3f oklab_of_lab(const Eigen::Vector3f& lab) {
    return optics::oklab_from_linear_srgb(light_of_lab(lab)).cast<float>();
}

/// d (by_oklab . oklab_of_lab(lab)) / d lab.
Eigen::Vector3f by_lab(const Eigen::Vector3f& lab, const Eigen::Vector3f& by_oklab) {
    const Eigen::Vector3d rgb = light_of_lab(lab);
    const Eigen::Matrix3d slope = optics::oklab_derivative(rgb) * optics::lab_derivative(rgb).inverse();
    return (slope.transpose() * by_oklab.cast<double>()).cast<float>();
}

}  // namespace

MisfitFunction::MisfitFunction(const optics::Surface& surface, const EyeFilter& eye,
                               std::span<const Eigen::Vector3f> target, std::span<const float> weight,
                               const EyeFilter* wide, std::vector<float> contrast_part)
    : eye_(eye),
      wide_(wide),
      contrast_part_(std::move(contrast_part)),
      target_(target),
      target_views_(eye.views(target)) {
    VOXTONE_EXPECT(!wide || contrast_part_.size() == target.size());
    VOXTONE_EXPECT(weight.empty() || weight.size() == target.size());
    double mean = 0;
    for (const optics::SurfaceCell& cell : surface.cells) mean += cell.area_mm2;
    mean /= static_cast<double>(std::max<std::size_t>(1, surface.cells.size()));
    for (const optics::SurfaceCell& cell : surface.cells) area_.push_back(static_cast<float>(cell.area_mm2 / mean));
    weight_.assign(area_.size(), 1);
    if (!weight.empty()) set_weights(weight);
}

void MisfitFunction::set_weights(std::span<const float> weight) {
    VOXTONE_EXPECT(weight.size() == area_.size());
    weight_.assign(weight.begin(), weight.end());
}

Misfit MisfitFunction::operator()(std::span<const Eigen::Vector3f> predicted, const EyeFilter::Views& views) const {
    VOXTONE_EXPECT(predicted.size() == target_.size());
    const std::size_t n = predicted.size();
    const std::vector<Eigen::Vector3f>& nearer = views.smoothed;
    std::vector<Eigen::Vector3f> far(n), near(n), as_is(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        far[i] = oklab_of_lab(views.lab[i]) - oklab_of_lab(target_views_.lab[i]);
        near[i] = oklab_of(nearer[i]) - oklab_of(target_views_.smoothed[i]);
    });
    // d - k S d; in the derivative it stands transposed, d - S k d: smoothing averages by area over neighbours, S_ij =
    // w_ij a_j / sum_j w_ij a_j with symmetric w, so where the sums are alike its transpose, with areas on either side,
    // is S again.
    const auto take_level = [&](bool transposed) {
        if (!wide_) return;
        std::vector<Eigen::Vector3f> lightness(n);
        parallel_for(0, n, 1024, [&](std::size_t i) {
            const float k = transposed ? contrast_part_[i] : 1;
            lightness[i] = {k * far[i][0], k * near[i][0], 0};
        });
        lightness = wide_->smoothed(lightness);
        parallel_for(0, n, 1024, [&](std::size_t i) {
            const float k = transposed ? 1 : contrast_part_[i];
            far[i][0] -= k * lightness[i][0];
            near[i][0] -= k * lightness[i][1];
        });
    };
    take_level(false);
    std::vector<double> value(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        const Part from_far = part_of(far[i]), from_near = part_of(near[i]),
                   by_itself = part_of(oklab_of(predicted[i]) - oklab_of(target_[i]));
        value[i] = static_cast<double>(area_[i] * weight_[i]) *
                   (from_far.value + static_cast<double>(gamma) * from_near.value +
                    static_cast<double>(beta) * by_itself.value);
        far[i] = weight_[i] * from_far.by_residual;
        near[i] = weight_[i] * gamma * from_near.by_residual;
        as_is[i] = weight_[i] * beta * by_light(predicted[i], by_itself.by_residual);
    });
    Misfit misfit;
    for (const double v : value) misfit.value += v;
    take_level(true);
    parallel_for(0, n, 1024, [&](std::size_t i) { far[i] = by_lab(views.lab[i], far[i]); });
    far = eye_.by_smoothed(far, views);
    parallel_for(0, n, 1024, [&](std::size_t i) { near[i] = far[i] + by_light(nearer[i], near[i]); });
    misfit.by_colour = eye_.smoothed(near);
    parallel_for(0, n, 1024, [&](std::size_t i) { misfit.by_colour[i] = area_[i] * (misfit.by_colour[i] + as_is[i]); });
    return misfit;
}

}  // namespace voxtone::halftone
