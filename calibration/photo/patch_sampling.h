// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean of an evenly coloured area of a photograph, robust against dust and scratches.
//
// The area is cut into blocks. The means of blocks are fitted with a plane (light may vary across the area) by
// iteratively reweighted least squares with Tukey's biweight (Beaton and Tukey 1974), a block that lies off in one
// channel losing its weight in all. Start and scale are those of the shortest half of the values (Rousseeuw 1984),
// since dirt lies on one side of a distribution. Blocks, not pixels: pixels of a dithered mixture differ by right, the
// means of many voxels differ less. Fails where more than about a third of the blocks is dirty.
#pragma once

#include <Eigen/Core>

#include "calibration/photo/rectify.h"
#include "calibration/target/target_layout.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct AreaSample {
    Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();     ///< in the middle of the area
    Eigen::Vector3d spread = Eigen::Vector3d::Zero();   ///< standard deviation of good blocks about the plane
    Eigen::Vector3d error = Eigen::Vector3d::Zero();    ///< standard error of the mean
    Eigen::Vector3d clipped = Eigen::Vector3d::Zero();  ///< share of pixels at or above the clipping level
    Eigen::Vector3d at_zero = Eigen::Vector3d::Zero();  ///< share of pixels at or below 0
    /// How much too large the mean is because noise was cut off at 0: of a normal distribution with that share below
    /// it.
    Eigen::Vector3d zero_excess = Eigen::Vector3d::Zero();
    std::size_t pixels = 0;
    double rejected = 0;    ///< share of the blocks
    bool complete = false;  ///< the whole area is in the picture and has enough pixels
};

/// `area` in the coordinates of `place`. Linear samples are averaged; `clip` is the level at which channels are
/// clipped.
[[nodiscard]] AreaSample sample_area(const io::Photograph& photograph, const Rectification& place, const Area& area,
                                     const Eigen::Vector3d& clip);

/// Where channels clip: full scale of integer samples; of floats the largest value where it is found many times, else
/// infinity.
[[nodiscard]] Eigen::Vector3d clipping_level(const io::Photograph& photograph);

/// Of an area's pixels that are clipped, and of its blocks that are not like the others: with more it counts for
/// nothing.
inline constexpr double clipped_share = 0.005, dirty_share = 0.33;

}  // namespace voxtone::calibration
