// SPDX-License-Identifier: GPL-3.0-or-later
//
// Finds a colour chart in a photograph (OpenCV's mcc, or corners by hand) and samples its patches.
//
// Which way the chart lies is told by its colours: the order of corners for which a 3 x 3 matrix explains them best.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/photo/checker_chart.h"
#include "calibration/photo/light_field.h"
#include "calibration/photo/patch_sampling.h"
#include "calibration/photo/rectify.h"

namespace voxtone::calibration {

struct CheckerView {
    Rectification place;              ///< of the chart's coordinates (checker_chart.h)
    std::vector<AreaSample> patches;  ///< in the chart's order
    double residual = 0;              ///< root mean square of the best matrix, of a perfect white
};

/// `hidden`: where the target lies; the chart is looked for elsewhere. `corners`: of the chart's cells, in any order
/// round it. Throws InputError where there is none, its colours fit in no order, or only mirrored.
[[nodiscard]] CheckerView find_checker_in(const io::Photograph& photograph, const CheckerChart& chart,
                                          const Eigen::Vector3d& clip, const std::array<Eigen::Vector2d, 4>& hidden,
                                          const std::optional<std::array<Eigen::Vector2d, 4>>& corners = std::nullopt);

/// Its patches that are neither clipped, nor dark, nor dirty, with the chart's colours.
[[nodiscard]] std::vector<LitSample> usable_patches(const CheckerView& view, const CheckerChart& chart);

/// The part of cell (column, row) that is sampled, in the chart's coordinates.
[[nodiscard]] Area checker_area(int column, int row);

}  // namespace voxtone::calibration
