// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colour: sRGB, CIE XYZ, CIELAB, CIEDE2000, Oklab.
//
// Conventions. A colour is an Eigen::Vector3d; its space is in the name of the function. Linear sRGB is relative to its
// white, (1, 1, 1), and may leave [0, 1]; XYZ has Y = 1 for white; the white is D65 as sRGB defines it, x = 0.3127, y =
// 0.3290, unless a white is given. L* runs from 0 to 100. Hue angles are radians except inside CIEDE2000. Sources: IEC
// 61966-2-1:1999 (sRGB; matrices computed from its primaries and white in double precision); CIE 15:2018 (Lab); Sharma,
// Wu, Dalal 2005, Color Res. Appl. 30:21 (CIEDE2000); Ottosson 2020 (Oklab); ICC.1:2022 Annex E (Bradford).
#pragma once

#include <span>

#include <Eigen/Core>

namespace voxtone::optics {

/// Encoded value in [0, 1] -> linear light and back (exact piecewise curve). Odd outside: f(-x) = -f(x).
[[nodiscard]] double srgb_decode(double encoded);
[[nodiscard]] double srgb_encode(double linear);

/// XYZ of D65 as sRGB has it, and of D50 as ICC profiles have it.
[[nodiscard]] Eigen::Vector3d d65_white();
[[nodiscard]] Eigen::Vector3d d50_white();

/// Rows X, Y, Z; columns R, G, B.
[[nodiscard]] const Eigen::Matrix3d& xyz_from_linear_srgb_matrix();

[[nodiscard]] Eigen::Vector3d xyz_from_linear_srgb(const Eigen::Vector3d& rgb);
[[nodiscard]] Eigen::Vector3d linear_srgb_from_xyz(const Eigen::Vector3d& xyz);

[[nodiscard]] Eigen::Vector3d lab_from_xyz(const Eigen::Vector3d& xyz, const Eigen::Vector3d& white = d65_white());
[[nodiscard]] Eigen::Vector3d xyz_from_lab(const Eigen::Vector3d& lab, const Eigen::Vector3d& white = d65_white());

[[nodiscard]] Eigen::Vector3d lab_from_linear_srgb(const Eigen::Vector3d& rgb);
[[nodiscard]] Eigen::Vector3d linear_srgb_from_lab(const Eigen::Vector3d& lab);
/// d lab_i / d rgb_j.
[[nodiscard]] Eigen::Matrix3d lab_derivative(const Eigen::Vector3d& rgb);

/// XYZ under one white that looks like `xyz` under another (Bradford).
[[nodiscard]] Eigen::Vector3d adapt_white(const Eigen::Vector3d& xyz, const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to);

/// Oklab: L in [0, 1], a and b within +-0.4; even in hue where Lab bends (blue).
[[nodiscard]] Eigen::Vector3d oklab_from_linear_srgb(const Eigen::Vector3d& rgb);
[[nodiscard]] Eigen::Vector3d linear_srgb_from_oklab(const Eigen::Vector3d& oklab);
/// d oklab_i / d rgb_j. Its slope is infinite at black: cone responses below 1e-6 count as 1e-6.
[[nodiscard]] Eigen::Matrix3d oklab_derivative(const Eigen::Vector3d& rgb);

/// CIEDE2000 colour difference, k_L = k_C = k_H = 1. Symmetric. Hues within 1e-9 degrees of opposite count as exactly
/// opposite, as they are in Sharma's pairs 10 and 14, where a rounding would otherwise choose the branch.
[[nodiscard]] double ciede2000(const Eigen::Vector3d& lab_1, const Eigen::Vector3d& lab_2);
/// W with ciede2000(lab, lab + d) = |W d| for small d.
[[nodiscard]] Eigen::Matrix3d ciede2000_metric(const Eigen::Vector3d& lab);

/// What is reported of a set of colour differences.
struct DifferenceSummary {
    std::size_t count = 0;
    double mean = 0, median = 0, percentile_95 = 0, max = 0;
};

/// Percentiles interpolate linearly between order statistics (Hyndman and Fan 1996, type 7). All zero for no
/// differences.
[[nodiscard]] DifferenceSummary summarize(std::span<const double> differences);

}  // namespace voxtone::optics
