// SPDX-License-Identifier: GPL-3.0-or-later
//
// From photographs of a target to its patch table: find the target, rectify, sample every square, find the chart, fit
// light and colours, average photographs. What cannot be measured is refused, naming the square; what is doubtful is
// said.
//
// Errors of the table: noise of the samples, the fit of light and colours (light_field.h), and how far photographs
// differ, whichever is larger. They do not hold what all photographs have in common: a chart that is not what its file
// says, a camera that sees colours as no matrix can relate, glare, light that wanders from one square to the next
// inside the slab.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/patches/patch_table.h"
#include "calibration/photo/colour_checker.h"
#include "calibration/photo/fiducials.h"
#include "calibration/photo/light_field.h"

namespace voxtone::calibration {

struct PhotoMeasureOptions {
    io::SampleCoding coding =
        io::SampleCoding::unknown;  ///< unknown: as the file says, else what the chart's greys say
    double inner = 0.6;             ///< part of a square's edge that is sampled, [0.1, 0.9]
    std::optional<std::array<Eigen::Vector2d, 4>> corners, checker_corners;  ///< by hand, px
};

struct PhotoMeasurement {
    io::Photograph photograph;  ///< linear
    TargetView view;
    CheckerView checker;
    PhotoModel model;
    std::vector<Area> square_areas, frame_areas;  ///< that were sampled
    std::vector<AreaSample> squares, frame;
    std::vector<Eigen::Vector3d> rho, error;  ///< of each square
    std::vector<std::string> warnings;
};

/// Throws InputError that names photograph and square.
[[nodiscard]] PhotoMeasurement measure_photo(io::Photograph photograph, const Target& target, const CheckerChart& chart,
                                             const PhotoMeasureOptions& options);

/// Where the light of a target's frame is sampled: places of the light resin away from all else.
[[nodiscard]] std::vector<Area> frame_areas(const Target& target);

/// What the squares of a target are told in. A chart's are always linear sRGB, signed: its fit finds channels itself.
/// A channel of `wide` is a mean over most of the spectrum, in which an ink is further from one medium than in one of
/// sRGB: other mixtures by smooth spectra were 9.8 to 10.9 CIEDE2000 off by three cameras, for 4.0 to 4.2 in sRGB cut
/// at 0 (benchmarks/calibration/target/rgb-against-spectral), so it is never chosen by itself.
enum class PhotoChannels {
    rgb,   ///< linear sRGB; what is below 0 is written as 0, and told
    wide,  ///< optics::wide_channels, in which no ink is negative, signed
};

struct MeasuredTable {
    PatchTable table;
    std::vector<Eigen::Vector3d> spread;  ///< between photographs; zero for one
    std::vector<std::string> warnings;
};

/// The mean of one or more photographs of the same target. Throws InputError.
[[nodiscard]] MeasuredTable average_photos(const std::vector<PhotoMeasurement>& photos, const Target& target,
                                           PhotoChannels channels = PhotoChannels::rgb);

}  // namespace voxtone::calibration
