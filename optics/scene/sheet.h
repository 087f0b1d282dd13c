// SPDX-License-Identifier: GPL-3.0-or-later
//
// A sheet under a body that is neither black nor white: how much of the light that falls on it it sends back, evenly
// into all directions, by place and channel. Between it and the body is a film of air without thickness: light comes
// back where it left.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace voxtone::optics {

struct Sheet {
    std::size_t channels = 0;
    std::array<int, 2> cells{1, 1};       ///< along x and y; beyond the outermost ones they go on
    std::array<double, 2> corner_mm{};    ///< of the first cell, from the corner of the volume
    std::array<double, 2> cell_mm{1, 1};  ///< > 0
    std::vector<float> reflectance;       ///< [(y * cells x + x) * channels + channel], in [0, 1]

    [[nodiscard]] float at(double x_mm, double y_mm, std::size_t channel) const;
    /// Mean over its cells.
    [[nodiscard]] double mean(std::size_t channel) const;
};

/// What a smooth surface of this index reflects of diffuse light in air: 0.092 at 1.5.
[[nodiscard]] double reflectance_in_air(double eta);
/// Of light that leaves a body towards a sheet, the share that comes in again: what its surface throws back on the
/// sheet, rho = reflectance_in_air, goes to and fro.
[[nodiscard]] inline double share_sent_back(double reflectance, double rho) {
    return reflectance * (1 - rho) / (1 - reflectance * rho);
}

}  // namespace voxtone::optics
