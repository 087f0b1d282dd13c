// SPDX-License-Identifier: GPL-3.0-or-later
//
// What physics leaves of a chart as a smooth function of shares (optics/media/colour_residual.h): the mean of a
// Gaussian process whose kernel is the residual's, one length a resin, and whose noise is a share of its variance.
//
//   weights = (K + nu / repeats)^-1 D,     left out itself, a mixture would be off by  weights_i / (K + nu /
//   repeats)^-1_ii
//
// Lengths and nu are those of the least mean CIEDE2000 of mixtures that were left out (Rasmussen, Williams 2006, Sec.
// 5.4.2), found one after the other from one length for all.
#pragma once

#include <vector>

#include "base/progress.h"
#include "calibration/chart/chart_data.h"
#include "optics/media/colour_residual.h"

namespace voxtone::calibration {

struct ResidualShape {
    std::vector<double> lengths;  ///< one per resin
    double noise = 0.01;          ///< nu, > 0
};

/// `left`: measured minus predicted roots of the mixtures; of several models, by one factorisation.
[[nodiscard]] optics::ColourResidual make_residual(const ChartData& data, const Eigen::MatrixX3d& left,
                                                   const ResidualShape& shape);
[[nodiscard]] std::vector<optics::ColourResidual> make_residuals(const ChartData& data,
                                                                 const std::vector<Eigen::MatrixX3d>& left,
                                                                 const ResidualShape& shape);

/// One length for all resins, as charts of five resins want it.
[[nodiscard]] ResidualShape usual_residual_shape(Eigen::Index resins);

struct ChosenResidual {
    ResidualShape shape;
    double left_out = 0;  ///< mean CIEDE2000 of mixtures left out, by the metric
    bool helps = false;   ///< less than without a residual
};

[[nodiscard]] ChosenResidual choose_residual_shape(const ChartData& data, const Eigen::MatrixX3d& left,
                                                   const Progress* progress = nullptr);

}  // namespace voxtone::calibration
