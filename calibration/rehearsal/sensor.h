// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera of all rehearsals: what it makes of the light of a scene, and how it sees a printed colour chart.
//
// A Gaussian blur, cos^4-like vignetting 1 / (1 + f r^2)^2, colours mixed by a matrix of the size of a real camera's,
// white balance, shot and read noise, clipping at 1.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "base/random.h"
#include "calibration/photo/checker_chart.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct Sensor {
    double vignetting = 0.1;                         ///< light lost in the corners of the picture, [0, 0.9]
    double exposure = 1;                             ///< 1: a perfect white is at 0.8 in the brightest channel
    Eigen::Vector3d white_balance{0.62, 1.0, 0.75};  ///< of the camera's channels
    double matrix = 1;         ///< how much the camera mixes colours: 0 not at all, 1 as cameras do
    double electrons = 20000;  ///< counted at 1: shot noise; 0: no noise
    double read_noise = 2e-4;  ///< standard deviation at 0
    std::uint64_t seed = 1;

    /// Throws InputError that names the option and the rule it breaks.
    void validate() const;
};

/// Throws InputError "NAME is VALUE; it must be from LEAST to MOST" unless it is.
void expect_within(std::string_view name, double value, double least, double most);

[[nodiscard]] double normal_number(RandomStream& random);
/// With shot noise, of so many electrons at 1, and read noise.
[[nodiscard]] double with_noise(double value, double electrons, double read_noise, RandomStream& random);

/// All black.
[[nodiscard]] io::Photograph black_photograph(std::uint32_t width_px, std::uint32_t height_px);
/// Light, 1 from a perfect white in full light, to what the sensor says of it. `seed` addresses the noise. The same
/// bits for any number of threads.
void expose(io::Photograph& light, const Sensor& sensor, double blur_px, std::uint64_t seed);

/// Of a place in cells right of a printed chart's upper left corner and down; `colours`: of its patches, which stand in
/// black frames.
[[nodiscard]] Eigen::Vector3d chart_colour(const CheckerChart& chart, std::span<const Eigen::Vector3d> colours,
                                           const Eigen::Vector2d& cell);

/// A light line, or a speck where it ends where it begins, in mm.
struct Stroke {
    Eigen::Vector2d from, to;
    double radius_mm;
    [[nodiscard]] bool hits(const Eigen::Vector2d& p) const;
};

}  // namespace voxtone::calibration
