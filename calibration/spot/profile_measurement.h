// SPDX-License-Identifier: GPL-3.0-or-later
//
// From photographs of one lit point to scattering profiles (Hasan et al. 2010, Sec. 4): exposures less their dark
// frames are merged (exposure_merge.h), the centre of highest radial symmetry is found (radial_centre.h), rings about
// it are averaged (radial_average.h) and scaled to the albedo that was measured apart.
//
// What the profile holds is the slab's, blurred by what lit it (a projected pixel, a pinhole) and by the camera: a
// coefficient at k cycles per mm is lowered by the factor of a disc of radius a, 2 J1(2 pi k a) / (2 pi k a), about 1 -
// (pi k a)^2 / 2. That is not taken back: noise at high k would grow without end, and the shape of the spot is seldom
// known so well.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/spot/exposure_merge.h"
#include "calibration/spot/radial_average.h"
#include "calibration/spot/radial_centre.h"
#include "optics/profiles/measured_profile.h"

namespace voxtone::calibration {

struct ProfileMeasureOptions {
    double mm_per_px = 0;         ///< on the slab
    double spacing_mm = 0.044;    ///< of samples: that of the paper
    double reach_mm = 0;          ///< of the last sample; 0: to the nearest border of the picture
    double most_asymmetry = 0.1;  ///< refused from here on
    CameraNoise noise;

    /// Throws InputError that names the option and the rule it breaks.
    void validate() const;
};

/// One side of a slab. Each exposure has a dark frame of the same time.
struct ExposureSeries {
    std::string name;  ///< "reflection", for messages
    std::vector<ExposureFile> lit, dark;
    Eigen::Vector3d total = Eigen::Vector3d::Zero();  ///< albedo of each channel, in (0, 1]
};

struct MeasuredSide {
    RadialCentre centre;
    std::array<RadialProfile, 3> profile;
    std::vector<double> seconds, step;  ///< exposure_merge.h
    std::vector<std::size_t> pixels;    ///< by the longest exposure that counts; the first: none does
    std::vector<std::string> warnings;
    double spacing_mm = 0;
    std::array<double, 3> total{};
    std::array<double, 3> tail{};  ///< share of the light in the last tenth of the samples
    [[nodiscard]] optics::RadialSamples samples(std::size_t channel) const;
};

/// Throws InputError in one sentence: what of the series is wrong; FileError.
[[nodiscard]] MeasuredSide measure_side(const ExposureSeries& series, const ProfileMeasureOptions& options,
                                        const Progress* progress = nullptr);

/// The same of pictures that were merged.
[[nodiscard]] MeasuredSide measure_merged(const MergedPicture& picture, const ExposureSeries& series,
                                          const ProfileMeasureOptions& options);

/// Throws InputError where a slab would reflect and transmit more than 1.02 of the light of a channel.
void expect_no_light_made(const Eigen::Vector3d& reflectance, const Eigen::Vector3d& transmittance);

/// k, cycles per mm, from where on a disc of this radius lowers coefficients by more than `share` (at most 0.5).
[[nodiscard]] double blurred_from(double radius_mm, double share);

}  // namespace voxtone::calibration
