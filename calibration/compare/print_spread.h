// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much wider than predicted colours run on a photographed print: the Gaussian that makes the prediction most like
// it (least squares, errors relative to brightness). Cells are squares of one colour each, so the weight of a cell at a
// distance of n cells is exactly
//
//   F(n + 1) - 2 F(n) + F(n - 1),    F(x) = x Phi(x / s) + s phi(x / s),    s in cells
//
// along each axis. Holds what the camera blurs too. A print sharper than predicted counts as 0.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

/// Each cell is the mean over itself of the picture that is smoothed so.
[[nodiscard]] std::vector<Eigen::Vector3f> spread_cells(std::span<const Eigen::Vector3f> rgb, int columns,
                                                        const Eigen::Vector2d& sigma_cells);

/// Standard deviation, mm. `counts`: of each cell, or not.
[[nodiscard]] double fitted_spread_mm(std::span<const Eigen::Vector3f> predicted, std::span<const Eigen::Vector3f> seen,
                                      std::span<const std::uint8_t> counts, int columns,
                                      const Eigen::Vector2d& cell_mm);

}  // namespace voxtone::calibration
