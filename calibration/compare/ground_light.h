// SPDX-License-Identifier: GPL-3.0-or-later
//
// Uneven light and vignetting from the ground around a print, which has one colour: the logarithm of what is seen there
// is a cubic of the place in the picture, fitted to means of blocks by iteratively reweighted least squares (Tukey's
// biweight), which leaves aside dirt, shadows of the print and other things that lie there. Between the ground's sides
// the light on the print is interpolated.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/compare/print_place.h"
#include "calibration/photo/light_field.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

/// Means of blocks of the ground, away from the print (and from `hidden`, a chart beside it). `reference` is not used.
[[nodiscard]] std::vector<LitSample> ground_samples(const io::Photograph& photograph, const PrintPlace& place,
                                                    const std::optional<PrintCorners>& hidden = std::nullopt);

class GroundLight {
public:
    static constexpr int terms = 10;

    /// Nothing where the ground is too dark, has too few even blocks or is not even.
    [[nodiscard]] static std::optional<GroundLight> fit(const std::vector<LitSample>& ground,
                                                        const io::Photograph& photograph);
    /// Not scaled.
    [[nodiscard]] double at(const Eigen::Vector2d& px) const;
    /// Relative deviation of the blocks that count.
    [[nodiscard]] double residual() const { return residual_; }

private:
    [[nodiscard]] Eigen::Matrix<double, terms, 1> basis(const Eigen::Vector2d& px) const;
    Eigen::Vector2d size_ = Eigen::Vector2d::Ones();
    Eigen::Matrix<double, terms, 1> of_log_ = Eigen::Matrix<double, terms, 1>::Zero();
    double residual_ = 0;
};

}  // namespace voxtone::calibration
