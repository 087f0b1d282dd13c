// SPDX-License-Identifier: GPL-3.0-or-later
//
// A function of two variables, sampled on a uniform grid and interpolated by a bicubic spline (de Boor, A Practical
// Guide to Splines, 1978, Ch. XVII): twice continuously differentiable, exact at the samples, error O(h^4). The ends
// are "not-a-knot", which keeps the order there. Arguments outside the grid are clamped, with derivative 0 across the
// edge.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace voxtone::optics {

class BicubicTable {
public:
    struct Value {
        double f, df_dx, df_dy;
    };

    BicubicTable() = default;
    /// samples(i, j) = f(i / (rows - 1) * x_max, j / (cols - 1) * y_max); at least 5 x 5 of them, x_max and y_max > 0.
    BicubicTable(const Eigen::MatrixXd& samples, double x_max, double y_max);

    [[nodiscard]] double operator()(double x, double y) const;
    [[nodiscard]] Value with_gradient(double x, double y) const;

private:
    struct Cell {
        int index;
        double t;
    };
    [[nodiscard]] static Cell locate(double scaled, int intervals);
    int rows_ = 0, stride_ = 0;  // intervals in x; coefficients per x
    int cols_ = 0;               // intervals in y
    double x_scale_ = 0, y_scale_ = 0;
    std::vector<double> coefficients_;  // (rows + 3) x stride, y fastest
};

}  // namespace voxtone::optics
