// SPDX-License-Identifier: GPL-3.0-or-later
//
// The target as it was measured: what photographs show of it, straightened, after the correction of light and colours,
// in their mean. Pixels are squares of the target, seen from above, rows from its largest y.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/photo/photo_measurement.h"
#include "calibration/target/target_layout.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::calibration {

class TargetPicture {
public:
    /// Up to 8 pixels a mm and 1000 a side.
    explicit TargetPicture(const Target& target);

    /// A photograph whose pixels are still there.
    void add(const PhotoMeasurement& measurement);
    /// Transparent where no photograph shows the target.
    [[nodiscard]] io::Picture8 mean() const;

private:
    [[nodiscard]] Eigen::Vector2d place_mm(std::uint32_t column, std::uint32_t row) const;

    Eigen::Vector2d size_mm_;
    std::uint32_t width_px_ = 0, height_px_ = 0;
    std::vector<Eigen::Vector4d> sums_;  // reflectances of all photographs, and how many they are
};

}  // namespace voxtone::calibration
