// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/colour.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "optics/numerics/portable_math.h"

namespace voxtone::optics {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d xyz_of_chromaticity(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

Matrix3d matrix(std::initializer_list<double> rows) {
    Matrix3d m;
    std::size_t k = 0;
    for (const double value : rows) {
        m(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) = value;
        ++k;
    }
    return m;
}

// The primaries, each as bright as makes their sum white.
Matrix3d srgb_matrix() {
    Matrix3d primaries;
    primaries.col(0) = xyz_of_chromaticity(0.64, 0.33);
    primaries.col(1) = xyz_of_chromaticity(0.30, 0.60);
    primaries.col(2) = xyz_of_chromaticity(0.15, 0.06);
    const Vector3d brightness = primaries.inverse() * d65_white();
    return primaries * brightness.asDiagonal();
}

const Matrix3d& linear_srgb_from_xyz_matrix() {
    static const Matrix3d m = xyz_from_linear_srgb_matrix().inverse();
    return m;
}

const Matrix3d& bradford() {
    static const Matrix3d m = matrix({0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296});
    return m;
}

const Matrix3d& oklab_cones() {
    static const Matrix3d m = matrix({0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451,
                                      0.1073969566, 0.0883024619, 0.2817188376, 0.6299787005});
    return m;
}

const Matrix3d& oklab_opponents() {
    static const Matrix3d m = matrix({0.2104542553, 0.7936177850, -0.0040720468, 1.9779984951, -2.4285922050,
                                      0.4505937099, 0.0259040371, 0.7827717662, -0.8086757660});
    return m;
}

// CIE 15: the cube root above (6/29)^3, the straight line that touches it below.
constexpr double lab_edge = 6.0 / 29;

double lab_curve(double t) {
    return t > lab_edge * lab_edge * lab_edge ? portable::cbrt(t) : t / (3 * lab_edge * lab_edge) + 4.0 / 29;
}

double lab_curve_inverse(double f) { return f > lab_edge ? f * f * f : 3 * lab_edge * lab_edge * (f - 4.0 / 29); }

double lab_slope(double t) {
    return t > lab_edge * lab_edge * lab_edge ? portable::cbrt(t) / (3 * t) : 1 / (3 * lab_edge * lab_edge);
}

double power_7(double x) {
    const double x2 = x * x;
    return x2 * x2 * x2 * x;
}

constexpr double degree = 3.14159265358979323846 / 180, pow_25_7 = 6103515625.0;

/// Of CIEDE2000: what a is stretched by for a mean chroma.
double stretch_of_a(double mean_c) {
    const double mean_c7 = power_7(mean_c);
    return 1 + 0.5 * (1 - std::sqrt(mean_c7 / (mean_c7 + pow_25_7)));
}

/// Degrees in [0, 360); 0 of a grey.
double hue_of(double a, double b) {
    if (a == 0 && b == 0) return 0;
    const double h = std::atan2(b, a) / degree;
    return h < 0 ? h + 360 : h;
}

/// Of CIEDE2000, for the mean of two colours.
struct DifferenceWeights {
    double S_L, S_C, S_H, R_T;
    DifferenceWeights(double mean_L, double mean_C, double mean_h) {
        const double T = 1 - 0.17 * std::cos((mean_h - 30) * degree) + 0.24 * std::cos(2 * mean_h * degree) +
                         0.32 * std::cos((3 * mean_h + 6) * degree) - 0.20 * std::cos((4 * mean_h - 63) * degree);
        const double from_275 = (mean_h - 275) / 25, from_50 = (mean_L - 50) * (mean_L - 50);
        const double rotation = 30 * std::exp(-from_275 * from_275), mean_C7 = power_7(mean_C);
        S_L = 1 + 0.015 * from_50 / std::sqrt(20 + from_50);
        S_C = 1 + 0.045 * mean_C;
        S_H = 1 + 0.015 * mean_C * T;
        R_T = -std::sin(2 * rotation * degree) * 2 * std::sqrt(mean_C7 / (mean_C7 + pow_25_7));
    }
};

}  // namespace

double srgb_decode(double encoded) {
    const double x = std::abs(encoded);
    return std::copysign(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4), encoded);
}

double srgb_encode(double linear) {
    const double x = std::abs(linear);
    return std::copysign(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055, linear);
}

Vector3d d65_white() { return xyz_of_chromaticity(0.3127, 0.3290); }

Vector3d d50_white() { return {0.96422, 1, 0.82521}; }

const Matrix3d& xyz_from_linear_srgb_matrix() {
    static const Matrix3d m = srgb_matrix();
    return m;
}

Vector3d xyz_from_linear_srgb(const Vector3d& rgb) { return xyz_from_linear_srgb_matrix() * rgb; }

Vector3d linear_srgb_from_xyz(const Vector3d& xyz) { return linear_srgb_from_xyz_matrix() * xyz; }

Vector3d lab_from_xyz(const Vector3d& xyz, const Vector3d& white) {
    const double fx = lab_curve(xyz[0] / white[0]), fy = lab_curve(xyz[1] / white[1]),
                 fz = lab_curve(xyz[2] / white[2]);
    return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

Vector3d xyz_from_lab(const Vector3d& lab, const Vector3d& white) {
    const double fy = (lab[0] + 16) / 116;
    return {white[0] * lab_curve_inverse(fy + lab[1] / 500), white[1] * lab_curve_inverse(fy),
            white[2] * lab_curve_inverse(fy - lab[2] / 200)};
}

Vector3d lab_from_linear_srgb(const Vector3d& rgb) { return lab_from_xyz(xyz_from_linear_srgb(rgb)); }

Vector3d linear_srgb_from_lab(const Vector3d& lab) { return linear_srgb_from_xyz(xyz_from_lab(lab)); }

Matrix3d lab_derivative(const Vector3d& rgb) {
    const Vector3d t = xyz_from_linear_srgb(rgb).cwiseQuotient(d65_white());
    Matrix3d of_curves;
    of_curves << 0, 116, 0, 500, -500, 0, 0, 200, -200;
    const Vector3d slope = t.unaryExpr(&lab_slope).cwiseQuotient(d65_white());
    return of_curves * slope.asDiagonal() * xyz_from_linear_srgb_matrix();
}

Vector3d adapt_white(const Vector3d& xyz, const Vector3d& from, const Vector3d& to) {
    const Vector3d gain = (bradford() * to).cwiseQuotient(bradford() * from);
    return bradford().inverse() * gain.cwiseProduct(bradford() * xyz);
}

Vector3d oklab_from_linear_srgb(const Vector3d& rgb) {
    const Vector3d cones = oklab_cones() * rgb;
    return oklab_opponents() * Vector3d(portable::cbrt(cones[0]), portable::cbrt(cones[1]), portable::cbrt(cones[2]));
}

Vector3d linear_srgb_from_oklab(const Vector3d& oklab) {
    static const Matrix3d from_opponents = oklab_opponents().inverse(), from_cones = oklab_cones().inverse();
    const Vector3d roots = from_opponents * oklab;
    return from_cones * roots.cwiseProduct(roots).cwiseProduct(roots);
}

Matrix3d oklab_derivative(const Vector3d& rgb) {
    const Vector3d cones = (oklab_cones() * rgb).cwiseMax(1e-6);
    const Vector3d slope = cones.unaryExpr([](double x) { return portable::cbrt(x) / (3 * x); });
    return oklab_opponents() * slope.asDiagonal() * oklab_cones();
}

double ciede2000(const Vector3d& lab_1, const Vector3d& lab_2) {
    constexpr double opposite = 180 + 1e-9;
    const double stretch = stretch_of_a(0.5 * (std::hypot(lab_1[1], lab_1[2]) + std::hypot(lab_2[1], lab_2[2])));
    const double a1 = stretch * lab_1[1], a2 = stretch * lab_2[1];
    const double c1 = std::hypot(a1, lab_1[2]), c2 = std::hypot(a2, lab_2[2]);
    const double h1 = hue_of(a1, lab_1[2]), h2 = hue_of(a2, lab_2[2]);

    double dh = 0, mean_h = h1 + h2;  // a grey has no hue: the other's hue counts
    if (c1 * c2 > 0) {
        dh = h2 - h1;
        const double apart = std::abs(dh);
        mean_h = 0.5 * (h1 + h2);
        if (apart > opposite) {
            dh += dh > 0 ? -360 : 360;
            mean_h += h1 + h2 < 360 ? 180 : -180;
        }
    }
    const double dL = lab_2[0] - lab_1[0], dC = c2 - c1, dH = 2 * std::sqrt(c1 * c2) * std::sin(0.5 * dh * degree);
    const DifferenceWeights weights(0.5 * (lab_1[0] + lab_2[0]), 0.5 * (c1 + c2), mean_h);
    const double l = dL / weights.S_L, c = dC / weights.S_C, h = dH / weights.S_H;
    return std::sqrt(std::max(0.0, l * l + c * c + h * h + weights.R_T * c * h));
}

Matrix3d ciede2000_metric(const Vector3d& lab) {
    const double stretch = stretch_of_a(std::hypot(lab[1], lab[2])), a = stretch * lab[1];
    const double hue = hue_of(a, lab[2]), cosine = std::cos(hue * degree), sine = std::sin(hue * degree);
    const DifferenceWeights weights(lab[0], std::hypot(a, lab[2]), hue);
    const Eigen::RowVector3d c = Eigen::RowVector3d(0, cosine * stretch, sine) / weights.S_C,
                             h = Eigen::RowVector3d(0, -sine * stretch, cosine) / weights.S_H;
    Matrix3d W;
    W.row(0) = Eigen::RowVector3d(1 / weights.S_L, 0, 0);
    // c^2 + h^2 + R_T c h as a sum of squares.
    W.row(1) = c + 0.5 * weights.R_T * h;
    W.row(2) = std::sqrt(1 - 0.25 * weights.R_T * weights.R_T) * h;
    return W;
}

DifferenceSummary summarize(std::span<const double> differences) {
    if (differences.empty()) return {};
    std::vector<double> sorted(differences.begin(), differences.end());
    std::sort(sorted.begin(), sorted.end());
    const auto quantile = [&](double share) {
        const double place = share * static_cast<double>(sorted.size() - 1);
        const auto below = static_cast<std::size_t>(place);
        const double t = place - static_cast<double>(below);
        return below + 1 < sorted.size() ? sorted[below] * (1 - t) + sorted[below + 1] * t : sorted[below];
    };
    double sum = 0;
    for (const double d : sorted) sum += d;
    return {sorted.size(), sum / static_cast<double>(sorted.size()), quantile(0.5), quantile(0.95), sorted.back()};
}

}  // namespace voxtone::optics
