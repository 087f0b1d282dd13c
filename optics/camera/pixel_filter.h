// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a pixel gathers light from the picture plane: by a Gaussian about its middle, cut off at one and a half pixels
// and scaled to 1, or from its own square alone. A camera's lens and sensor blur by as much; and a sample counts in up
// to nine pixels, so that noise falls to a third (sigma 0.5).
//
// With samples evenly over each pixel s, and weights w of the filter of pixel t,
//   value_t = sum_s mean_s(w f) / sum_s mean_s(w)
// M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 3rd ed. 2016, Sec. 7.8.
#pragma once

#include <array>

namespace voxtone::optics {

class PixelFilter {
public:
    /// Standard deviation in pixels, in [0, 1]; 0: the square.
    explicit PixelFilter(double sigma_px);

    /// Pixels beyond its own that a pixel gathers from: 0 or 1.
    [[nodiscard]] int reach() const { return sigma_ > 0 ? 1 : 0; }
    /// Along one axis, of what lies `off_px` from the pixel's middle; the integral is 1.
    [[nodiscard]] double weight(double off_px) const;
    /// Means of the weight, and of its square, along one axis over the pixel before (0), its own (1), the one after.
    [[nodiscard]] const std::array<double, 3>& mean() const { return mean_; }
    [[nodiscard]] const std::array<double, 3>& mean_square() const { return mean_square_; }

private:
    double sigma_, scale_ = 1;
    std::array<double, 3> mean_{0, 1, 0}, mean_square_{0, 1, 0};
};

}  // namespace voxtone::optics
