// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pixels of a picture about a point, by the rings they lie in.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "calibration/spot/exposure_merge.h"

namespace voxtone::calibration {

/// Samples of a profile about a point.
struct RadialPlan {
    Eigen::Vector2d centre_px;             ///< the middle of the first pixel is at (0.5, 0.5)
    double mm_per_px = 0, spacing_mm = 0;  ///< a pixel is not wider than the spacing
    std::size_t samples = 0;               ///< at least 4; all rings lie within the picture
    [[nodiscard]] double reach_px() const { return static_cast<double>(samples - 1) * spacing_mm / mm_per_px; }
};

/// Lies between sample `ring` (share 1 - t) and the next one (share t).
struct RingPixel {
    std::size_t ring = 0;
    double t = 0, light = 0, weight = 0;  ///< weight 0: no exposure counts
    Eigen::Vector2d offset_px;            ///< from the centre

    /// Of straight lines between samples.
    template <class Samples>
    [[nodiscard]] double between(const Samples& samples) const {
        const auto i = static_cast<Eigen::Index>(ring);
        return (1 - t) * samples[i] + t * samples[i + 1];
    }
};

/// Calls body(pixel) for every pixel whose middle is nearer to the centre than the last sample, row by row.
template <class Body>
void for_ring_pixels(const MergedPicture& picture, int channel, const RadialPlan& plan, Body&& body) {
    const double reach = plan.reach_px(), per_px = plan.mm_per_px / plan.spacing_mm;
    const auto first = [&](double middle) {
        return static_cast<std::uint32_t>(std::max(0.0, std::floor(middle - reach)));
    };
    const auto end = [&](double middle, std::uint32_t size) {
        return static_cast<std::uint32_t>(std::clamp(std::ceil(middle + reach), 0.0, static_cast<double>(size)));
    };
    for (std::uint32_t y = first(plan.centre_px.y()); y < end(plan.centre_px.y(), picture.height_px); ++y)
        for (std::uint32_t x = first(plan.centre_px.x()); x < end(plan.centre_px.x(), picture.width_px); ++x) {
            RingPixel pixel;
            pixel.offset_px = Eigen::Vector2d(x + 0.5, y + 0.5) - plan.centre_px;
            const double at = pixel.offset_px.norm() * per_px;
            pixel.ring = static_cast<std::size_t>(at);
            if (pixel.ring + 1 >= plan.samples) continue;
            pixel.t = at - static_cast<double>(pixel.ring);
            const std::size_t i = picture.index(x, y);
            pixel.light = picture.light[i][channel], pixel.weight = picture.weight[i][channel];
            body(pixel);
        }
}

}  // namespace voxtone::calibration
