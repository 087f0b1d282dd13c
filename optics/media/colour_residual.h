// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the physics of a set leaves of measured mixtures: a smooth function of the shares, kept as weighted kernels.
//
//   d_k(f) = sum_i w_ik m(|x(f) - x(f_i)|),   m(r) = (1 + sqrt(3) r) exp(-sqrt(3) r)   (Matern, 3/2)
//   x_r(f) = ln(1 + f_r / 0.01) / ln(101) / length_r
//
// d is added to the lightness-like roots of X, Y and Z, each relative to the white of the set's illuminant: to CIELAB's
// f(X / Xn), f(Y / Yn), f(Z / Zn). The logarithm makes steps of small shares as large as the eye sees them: 1 % of an
// ink in white is seen, 1 % more in half of it is not. Away from its centres d fades to 0: nothing is extrapolated.
// Rasmussen, Williams 2006, Gaussian Processes for Machine Learning, Secs. 2.2 and 4.2.
//
// Continuous with its first derivative. Immutable after construction.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::optics {

class ColourResidual {
public:
    /// 0 everywhere.
    ColourResidual() = default;
    /// `lengths`: one per resin, > 0. `centres`: shares, one row per centre, one column per resin. `weights`: one row
    /// per centre, columns X, Y, Z.
    ColourResidual(std::vector<double> lengths, Eigen::MatrixXd centres, Eigen::MatrixX3d weights);

    [[nodiscard]] bool empty() const { return weights_.rows() == 0; }
    [[nodiscard]] const std::vector<double>& lengths() const { return lengths_; }
    [[nodiscard]] const Eigen::MatrixXd& centres() const { return centres_; }
    [[nodiscard]] const Eigen::MatrixX3d& weights() const { return weights_; }

    [[nodiscard]] Eigen::Vector3d operator()(std::span<const double> shares) const;
    /// And its derivatives: one column per resin, every share taken as free.
    [[nodiscard]] Eigen::Vector3d with_gradient(std::span<const double> shares, Eigen::Matrix3Xd& by_share) const;

    /// For mixtures of these resins only (columns of `centres`, in this order); the others have no share.
    [[nodiscard]] ColourResidual subset(std::span<const std::size_t> resins) const;

    /// x(f) of one row of shares, and m of a distance: also for those who fit the weights.
    [[nodiscard]] static Eigen::RowVectorXd place(std::span<const double> shares, std::span<const double> lengths);
    [[nodiscard]] static double kernel(double distance);

    friend bool operator==(const ColourResidual& a, const ColourResidual& b) {
        return a.lengths_ == b.lengths_ && a.centres_ == b.centres_ && a.weights_ == b.weights_;
    }

private:
    std::vector<double> lengths_;
    Eigen::MatrixXd centres_;
    Eigen::MatrixX3d weights_;
    Eigen::MatrixXd places_;  ///< x of the centres, one column per centre
    Eigen::VectorXd aside_;   ///< squared distance of each centre by resins that a subset left out
};

}  // namespace voxtone::optics
