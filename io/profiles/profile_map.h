// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which scattering is wanted where (format "voxtone-profile-map"): a picture of cluster numbers and one wanted
// reflection profile for each cluster (Hasan et al. 2010, Sec. 7.1). A JSON file with an 8- or 16-bit grey PNG beside
// it.
//
//   {"format": "voxtone-profile-map", "version": 1, "source": "...", "channels": "rgb" | [nm, ...],
//    "size_mm": [width, height], "picture": "name.png" (no folder in it; pixel value = number of the cluster),
//    "spacing_mm": 0.1, "clusters": [[[light of channel 0 ...], [channel 1 ...], ...], ...]}
//
// Light is per mm^2 of one unit that entered, as in a target profile (profile_file.h) without `total`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "optics/media/resins.h"
#include "optics/profiles/measured_profile.h"

namespace voxtone::io {

struct ProfileMap {
    std::string source;
    std::string picture;  ///< name of the PNG that the clusters were read from, in the map's folder
    optics::Channels channels;
    double width_mm = 0, height_mm = 0;
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<std::uint16_t> cluster;                      ///< rows from the top; below targets.size()
    std::vector<std::vector<optics::RadialSamples>> target;  ///< [cluster][channel]: all of one spacing and length
};

/// Throws FileError, InputError that names file, key and rule: also for pixels without a cluster.
[[nodiscard]] ProfileMap read_profile_map(const std::filesystem::path& file);
/// NAME.png beside NAME.json.
[[nodiscard]] std::filesystem::path profile_map_picture(const std::filesystem::path& file);
/// The JSON file and its picture. Overwrites.
void write_profile_map(const ProfileMap& map, const std::filesystem::path& file);

}  // namespace voxtone::io
