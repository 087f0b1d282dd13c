// SPDX-License-Identifier: GPL-3.0-or-later
//
// A printer's ICC profile as a chart of mixtures: what `calibrate icc` fits.
//
// The device's channels are taken as shares of the volume, with white as the rest, so that only amounts that sum to 1
// at most are mixtures. Their colours are those of the profile's table from device to colour (ICC.1:2022: A2B1, else
// A2B0), CIELAB under D50, 2 degree. A profile that carries the measurements that it was made of (CGATS in `targ`,
// CxF3 in `CxF `) gives these instead, as far as they are such mixtures.
//
// What a profile cannot tell: how its makers smoothed and extrapolated, and whether the printer's software halftones a
// channel's amount as that share of the volume.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/patches/patch_table.h"
#include "io/profiles/device_profile.h"

namespace voxtone::calibration {

/// What the profile's colours are relative to.
enum class ProfileWhite {
    perfect_diffuser,  ///< ICC-absolute colorimetric
    medium,            ///< relative colorimetric: the printer's white is white
};

struct IccChartOptions {
    std::vector<std::string> channels_are;  ///< role of each channel; empty: C, M, Y, K or C, M, Y by the colour space
    std::string rest = "W";                 ///< role of what lies beside the channels' resins
    std::size_t patches = 400;              ///< mixtures to take from the table, 10 to 10000
    ProfileWhite white = ProfileWhite::perfect_diffuser;

    /// Throws UsageError that names the option, its value and the rule.
    void validate() const;
};

struct IccChart {
    PatchTable table;
    std::string description;                          ///< the profile's own
    std::string colour_space;                         ///< "CMYK"
    Eigen::Vector3d white = Eigen::Vector3d::Zero();  ///< CIELAB of no ink, relative to a perfect diffuser
    std::string measured;                             ///< tag that the patches come from; empty: the profile's table
};

/// Farther from white than this, amounts of 0 are not the white of a printer.
inline constexpr double least_white_lightness = 50, most_white_chroma = 20;

/// Roles of the channels. Throws InputError: a profile that is no printer's or whose channels are no resins, no table
/// from device to colour, other names than channels.
[[nodiscard]] std::vector<std::string> channel_roles(const io::DeviceProfile& profile, const IccChartOptions& options);

/// From a profile whose samples are those of mixture_samples.h. Throws InputError: a white that is none, what
/// finished_chart refuses.
[[nodiscard]] IccChart chart_of_profile(const io::DeviceProfile& profile, const IccChartOptions& options);

/// Throws UsageError, FileError, InputError, ResourceError, Cancelled.
[[nodiscard]] IccChart read_icc_chart(const std::filesystem::path& file, const IccChartOptions& options,
                                      const Progress* progress = nullptr);

}  // namespace voxtone::calibration
