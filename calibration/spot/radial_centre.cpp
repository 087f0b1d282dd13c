// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/radial_centre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "calibration/spot/radial_average.h"

namespace voxtone::calibration {
namespace {

constexpr double centre_blur_px = 2, clear_light = 8, arrived_px = 1e-4, arrived_share = 0.02, longest_step_px = 2;
constexpr int most_steps = 50;
constexpr double fewest_rings = 16;

// All channels together: light over its noise.
cv::Mat signal_of(const MergedPicture& picture) {
    cv::Mat signal(static_cast<int>(picture.height_px), static_cast<int>(picture.width_px), CV_32F);
    float* out = signal.ptr<float>();
    for (std::size_t i = 0; i < picture.light.size(); ++i) {
        const Eigen::Vector3f &x = picture.light[i], &w = picture.weight[i];
        out[i] = x.dot(w.cwiseSqrt());
    }
    return signal;
}

cv::Mat light_of(const MergedPicture& picture) {
    cv::Mat light(static_cast<int>(picture.height_px), static_cast<int>(picture.width_px), CV_32F);
    float* out = light.ptr<float>();
    for (std::size_t i = 0; i < picture.light.size(); ++i) out[i] = picture.light[i].sum();
    return light;
}

cv::Mat blurred(const cv::Mat& in) {
    cv::Mat out;
    cv::GaussianBlur(in, out, cv::Size(), centre_blur_px, centre_blur_px, cv::BORDER_REPLICATE);
    return out;
}

Eigen::Vector2d middle_of_light(const MergedPicture& picture) {
    double highest_signal = 0;
    cv::minMaxLoc(blurred(signal_of(picture)), nullptr, &highest_signal);
    // Three channels' noise of 1 each, averaged over 4 pi blur^2 pixels.
    const double noise = std::sqrt(3 / (4 * std::numbers::pi * centre_blur_px * centre_blur_px));
    if (!(highest_signal > clear_light * noise))
        throw InputError(
            "no light stands out above the dark frames; check that the spot was on, in the picture and not saturated "
            "in every exposure, and that lit and "
            "dark exposures are not swapped");
    const cv::Mat light = blurred(light_of(picture));
    double highest = 0;
    cv::minMaxLoc(light, nullptr, &highest);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double mass = 0;
    for (int y = 0; y < light.rows; ++y)
        for (int x = 0; x < light.cols; ++x) {
            const double above = static_cast<double>(light.at<float>(y, x)) - highest / 2;
            if (above > 0) sum += above * Eigen::Vector2d(x + 0.5, y + 0.5), mass += above;
        }
    return sum / mass;
}

// Normal equations of the step towards the centre, and the variance of their right side as pixels scatter.
struct Step {
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero(), B = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
};

Step step_from(const MergedPicture& picture, const RadialPlan& plan) {
    Step step;
    for (int c = 0; c < 3; ++c) {
        const std::vector<double> light = fit_rings(picture, c, plan);
        const Eigen::Map<const Eigen::VectorXd> profile(light.data(), static_cast<Eigen::Index>(light.size()));
        for_ring_pixels(picture, c, plan, [&](const RingPixel& p) {
            const double r = p.offset_px.norm();
            if (!(p.weight > 0) || r == 0) return;
            const double away = p.light - p.between(profile),
                         slope = (light[p.ring + 1] - light[p.ring]) / plan.spacing_mm;
            const Eigen::Vector2d pull = -slope / r * p.offset_px;  // change of the profile here as the centre moves
            step.A += p.weight * pull * pull.transpose();
            step.b += p.weight * away * pull;
            step.B += p.weight * away * p.weight * away * pull * pull.transpose();
        });
    }
    return step;
}

}  // namespace

double border_distance_px(const MergedPicture& picture, const Eigen::Vector2d& centre_px) {
    return std::min(
        {centre_px.x(), centre_px.y(), picture.width_px - centre_px.x(), picture.height_px - centre_px.y()});
}

RadialCentre find_radial_centre(const MergedPicture& picture, double spacing_px, double reach_px) {
    RadialCentre centre{middle_of_light(picture), Eigen::Vector2d::Zero(), 0};
    Eigen::Vector2d last_full = Eigen::Vector2d::Zero();
    double damping = 1;
    while (true) {
        const double border = border_distance_px(picture, centre.px);
        if (border < fewest_rings * spacing_px)
            throw InputError(fmt::format(
                "the centre of the spot, at ({:.1f}, {:.1f}) px, lies {:.0f} px from the border; the profile "
                "would end there: photograph more of what is about the spot",
                centre.px.x(), centre.px.y(), std::max(0.0, border)));
        // In pixels throughout.
        const RadialPlan plan{centre.px, 1, spacing_px,
                              1 + static_cast<std::size_t>(std::min(border, reach_px) / spacing_px)};
        const Step step = step_from(picture, plan);
        const Eigen::Matrix2d inverse = step.A.inverse();
        const Eigen::Vector2d full = inverse * step.b;
        if (!full.allFinite() || centre.steps == most_steps)
            throw InputError(
                "no centre was found about which the light falls off alike to all sides; is there one spot only?");
        // Gauss-Newton goes to and fro about spots that are faint or not round.
        if (full.dot(last_full) < 0) damping /= 2;
        last_full = full;
        Eigen::Vector2d move = damping * full;
        centre.error_px = (inverse * step.B * inverse).diagonal().cwiseSqrt();
        if (move.norm() < std::max(arrived_px, arrived_share * centre.error_px.norm())) return centre;
        if (move.norm() > longest_step_px) move *= longest_step_px / move.norm();
        centre.px += move;
        ++centre.steps;
    }
}

}  // namespace voxtone::calibration
