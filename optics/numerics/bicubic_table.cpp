// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/bicubic_table.h"

#include <algorithm>

#include <Eigen/LU>

#include "base/contracts.h"

namespace voxtone::optics {

namespace {

// Maps n samples to the n + 2 coefficients of the cubic B-spline through them. The two last rows are the not-a-knot
// conditions: no jump of the third derivative at the second and the last but one sample.
Eigen::MatrixXd samples_to_coefficients(Eigen::Index n) {
    Eigen::MatrixXd collocation = Eigen::MatrixXd::Zero(n + 2, n + 2);
    for (Eigen::Index i = 0; i < n; ++i) collocation.row(i).segment(i, 3) << 1.0 / 6, 4.0 / 6, 1.0 / 6;
    collocation.row(n).head(5) << 1, -4, 6, -4, 1;
    collocation.row(n + 1).tail(5) << 1, -4, 6, -4, 1;
    return collocation.partialPivLu().inverse().leftCols(n);
}

// The four cubic B-splines that are not zero on an interval, at t in [0, 1] of it.
std::array<double, 4> basis(double t) {
    const double u = 1 - t;
    return {u * u * u / 6, (t * t * (3 * t - 6) + 4) / 6, (u * u * (3 * u - 6) + 4) / 6, t * t * t / 6};
}

std::array<double, 4> basis_derivative(double t) {
    const double u = 1 - t;
    return {-u * u / 2, t * (3 * t - 4) / 2, -u * (3 * u - 4) / 2, t * t / 2};
}

}  // namespace

BicubicTable::BicubicTable(const Eigen::MatrixXd& samples, double x_max, double y_max) {
    VOXTONE_EXPECT(samples.rows() >= 5 && samples.cols() >= 5 && x_max > 0 && y_max > 0);
    rows_ = static_cast<int>(samples.rows()) - 1;
    cols_ = static_cast<int>(samples.cols()) - 1;
    stride_ = cols_ + 3;
    x_scale_ = rows_ / x_max;
    y_scale_ = cols_ / y_max;
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> coefficients =
        samples_to_coefficients(samples.rows()) * samples * samples_to_coefficients(samples.cols()).transpose();
    coefficients_.assign(coefficients.data(), coefficients.data() + coefficients.size());
}

BicubicTable::Cell BicubicTable::locate(double scaled, int intervals) {
    const double inside = std::clamp(scaled, 0.0, static_cast<double>(intervals));
    const int index = std::min(static_cast<int>(inside), intervals - 1);
    return {index, inside - index};
}

double BicubicTable::operator()(double x, double y) const {
    const Cell cx = locate(x * x_scale_, rows_), cy = locate(y * y_scale_, cols_);
    const std::array<double, 4> bx = basis(cx.t), by = basis(cy.t);
    const double* c = coefficients_.data() + cx.index * stride_ + cy.index;
    double f = 0;
    for (std::size_t i = 0; i < 4; ++i, c += stride_)
        f += bx[i] * (c[0] * by[0] + c[1] * by[1] + c[2] * by[2] + c[3] * by[3]);
    return f;
}

BicubicTable::Value BicubicTable::with_gradient(double x, double y) const {
    const Cell cx = locate(x * x_scale_, rows_), cy = locate(y * y_scale_, cols_);
    const std::array<double, 4> bx = basis(cx.t), by = basis(cy.t);
    const std::array<double, 4> dx = basis_derivative(cx.t), dy = basis_derivative(cy.t);
    const double* c = coefficients_.data() + cx.index * stride_ + cy.index;
    Value value{0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i, c += stride_) {
        const double row = c[0] * by[0] + c[1] * by[1] + c[2] * by[2] + c[3] * by[3];
        const double slope = c[0] * dy[0] + c[1] * dy[1] + c[2] * dy[2] + c[3] * dy[3];
        value.f += bx[i] * row;
        value.df_dx += dx[i] * row;
        value.df_dy += bx[i] * slope;
    }
    const bool inside_x = x >= 0 && x * x_scale_ <= rows_, inside_y = y >= 0 && y * y_scale_ <= cols_;
    value.df_dx = inside_x ? value.df_dx * x_scale_ : 0;
    value.df_dy = inside_y ? value.df_dy * y_scale_ : 0;
    return value;
}

}  // namespace voxtone::optics
