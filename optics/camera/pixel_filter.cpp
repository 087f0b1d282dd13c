// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/pixel_filter.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

constexpr double reach_px = 1.5;

}  // namespace

PixelFilter::PixelFilter(double sigma_px) : sigma_(sigma_px) {
    VOXTONE_EXPECT(sigma_px >= 0 && sigma_px <= 1);
    if (sigma_ == 0) return;
    const auto below = [&](double off, double sigma) { return 0.5 * std::erf(off / (sigma * std::sqrt(2.0))); };
    const auto integral = [&](double from, double to, double sigma) { return below(to, sigma) - below(from, sigma); };
    scale_ = 1 / integral(-reach_px, reach_px, sigma_) / (sigma_ * std::sqrt(2 * std::numbers::pi));
    // The square of a Gaussian is one of sigma / sqrt(2).
    const double narrow = sigma_ / std::sqrt(2.0), square = scale_ * scale_ * narrow * std::sqrt(2 * std::numbers::pi);
    for (int k = 0; k < 3; ++k) {
        const double from = k - 1.5, to = k - 0.5;
        mean_[static_cast<std::size_t>(k)] =
            scale_ * sigma_ * std::sqrt(2 * std::numbers::pi) * integral(from, to, sigma_);
        mean_square_[static_cast<std::size_t>(k)] = square * integral(from, to, narrow);
    }
}

double PixelFilter::weight(double off_px) const {
    if (sigma_ == 0) return std::abs(off_px) <= 0.5 ? 1 : 0;
    if (std::abs(off_px) > reach_px) return 0;
    const double x = off_px / sigma_;
    return scale_ * std::exp(-0.5 * x * x);
}

}  // namespace voxtone::optics
