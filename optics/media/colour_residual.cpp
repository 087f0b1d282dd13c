// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/colour_residual.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/contracts.h"

namespace voxtone::optics {

namespace {

constexpr double small_share = 0.01;
const double share_scale = 1 / std::log1p(1 / small_share);

// Shares a rounding below 0 count as 0.
double place_of(double share, double length) {
    return std::log1p(std::max(share, 0.0) / small_share) * share_scale / length;
}

double place_derivative(double share, double length) {
    return share_scale / (small_share + std::max(share, 0.0)) / length;
}

const double root_3 = std::sqrt(3.0);

}  // namespace

double ColourResidual::kernel(double distance) { return (1 + root_3 * distance) * std::exp(-root_3 * distance); }

Eigen::RowVectorXd ColourResidual::place(std::span<const double> shares, std::span<const double> lengths) {
    VOXTONE_EXPECT(shares.size() == lengths.size());
    Eigen::RowVectorXd x(static_cast<Eigen::Index>(shares.size()));
    for (std::size_t r = 0; r < shares.size(); ++r) x[static_cast<Eigen::Index>(r)] = place_of(shares[r], lengths[r]);
    return x;
}

ColourResidual::ColourResidual(std::vector<double> lengths, Eigen::MatrixXd centres, Eigen::MatrixX3d weights)
    : lengths_(std::move(lengths)), centres_(std::move(centres)), weights_(std::move(weights)) {
    VOXTONE_EXPECT(centres_.rows() == weights_.rows());
    VOXTONE_EXPECT(static_cast<std::size_t>(centres_.cols()) == lengths_.size());
    places_.resize(centres_.cols(), centres_.rows());
    for (Eigen::Index i = 0; i < centres_.rows(); ++i)
        for (Eigen::Index r = 0; r < centres_.cols(); ++r)
            places_(r, i) = place_of(centres_(i, r), lengths_[static_cast<std::size_t>(r)]);
    aside_ = Eigen::VectorXd::Zero(centres_.rows());
}

Eigen::Vector3d ColourResidual::operator()(std::span<const double> shares) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    if (empty()) return sum;
    const Eigen::VectorXd x = place(shares, lengths_).transpose();
    for (Eigen::Index i = 0; i < places_.cols(); ++i)
        sum += kernel(std::sqrt(aside_[i] + (places_.col(i) - x).squaredNorm())) * weights_.row(i).transpose();
    return sum;
}

Eigen::Vector3d ColourResidual::with_gradient(std::span<const double> shares, Eigen::Matrix3Xd& by_share) const {
    const auto resins = static_cast<Eigen::Index>(shares.size());
    by_share.setZero(3, resins);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    if (empty()) return sum;
    const Eigen::VectorXd x = place(shares, lengths_).transpose();
    for (Eigen::Index i = 0; i < places_.cols(); ++i) {
        const Eigen::VectorXd step = x - places_.col(i);
        const double distance = std::sqrt(aside_[i] + step.squaredNorm());
        const double decay = std::exp(-root_3 * distance);
        sum += (1 + root_3 * distance) * decay * weights_.row(i).transpose();
        // m'(r) / r = -3 exp(-sqrt(3) r)
        by_share += weights_.row(i).transpose() * (-3 * decay * step.transpose());
    }
    for (Eigen::Index r = 0; r < resins; ++r) {
        const auto k = static_cast<std::size_t>(r);
        by_share.col(r) *= place_derivative(shares[k], lengths_[k]);
    }
    return sum;
}

ColourResidual ColourResidual::subset(std::span<const std::size_t> resins) const {
    if (empty()) return {};
    std::vector<double> lengths;
    Eigen::MatrixXd centres(centres_.rows(), static_cast<Eigen::Index>(resins.size()));
    for (std::size_t k = 0; k < resins.size(); ++k) {
        VOXTONE_EXPECT(resins[k] < lengths_.size());
        lengths.push_back(lengths_[resins[k]]);
        centres.col(static_cast<Eigen::Index>(k)) = centres_.col(static_cast<Eigen::Index>(resins[k]));
    }
    ColourResidual chosen(std::move(lengths), std::move(centres), weights_);
    const Eigen::VectorXd all = aside_ + places_.colwise().squaredNorm().transpose();
    chosen.aside_ = (all - chosen.places_.colwise().squaredNorm().transpose()).cwiseMax(0);
    return chosen;
}

}  // namespace voxtone::optics
