// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/wavelet_gradient.h"

#include <algorithm>

#include "base/contracts.h"

namespace voxtone::calibration {
namespace {

// a with the taps of b spread apart by `step`.
Eigen::VectorXd convolved(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Eigen::Index step) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(a.size() + (b.size() - 1) * step);
    for (Eigen::Index k = 0; k < b.size(); ++k) sum.segment(k * step, a.size()) += b[k] * a;
    return sum;
}

}  // namespace

Eigen::VectorXd wavelet_derivative_taps(int level) {
    VOXTONE_EXPECT(level >= 1 && level <= 8);
    const Eigen::VectorXd low = Eigen::Vector4d(1, 3, 3, 1) / 8, high = Eigen::Vector2d(-1, 1);
    Eigen::VectorXd taps = Eigen::VectorXd::Ones(1);
    for (int j = 0; j + 1 < level; ++j) taps = convolved(taps, low, Eigen::Index{1} << j);
    taps = convolved(taps, high, Eigen::Index{1} << (level - 1));
    return taps / static_cast<double>(1 << (level - 1));  // a ramp of 1 a sample gives 2^(level - 1) before
}

Eigen::MatrixXd wavelet_gradient_map(Eigen::Index samples, int level) {
    const Eigen::VectorXd taps = wavelet_derivative_taps(level);
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(samples - 1, samples);
    for (Eigen::Index k = 0; k + 1 < samples; ++k)
        for (Eigen::Index i = 0; i < taps.size(); ++i)
            map(k, std::clamp<Eigen::Index>(k + 1 - taps.size() / 2 + i, 0, samples - 1)) += taps[i];
    return map;
}

}  // namespace voxtone::calibration
