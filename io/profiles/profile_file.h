// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scattering profiles as JSON files (format "voxtone-profile"): what was measured of one layer of a material, or what
// is wanted of a surface.
//
//   {"format": "voxtone-profile", "version": 1, "name": "VeroWhite", "source": "...",
//    "channels": "rgb" | [450, 550, ...] (nm),  "thickness_mm": 0.3,
//    "R": {"spacing_mm": 0.044, "light": [[...], [...], [...]], "error": [[...], [...], [...]], "total": [...]},
//    "T": {...}}
//
// light[channel][i]: light per mm^2 at the distance i * spacing_mm from where one unit entered; with `total` (albedos,
// one per channel) in any unit, scaled to them when it is used (optics/profiles/measured_profile.h). `error`, where
// known: the standard error of each. A target has R only and no thickness.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "optics/media/resins.h"
#include "optics/profiles/measured_profile.h"

namespace voxtone::io {

struct ProfileFile {
    std::string name, source;
    optics::Channels channels;
    std::vector<optics::MeasuredProfile> by_channel;  ///< a target: thickness 0, T without samples
    [[nodiscard]] bool is_target() const { return by_channel.empty() || by_channel[0].T.light.empty(); }
};

/// Throws InputError that names file, key and rule: lengths that differ between channels, fewer than four samples,
/// values that are not finite, spacing or thickness not above 0, totals outside [0, 1].
[[nodiscard]] ProfileFile parse_profile(std::string_view text, std::string source);
/// Throws FileError, InputError.
[[nodiscard]] ProfileFile read_profile(const std::filesystem::path& file);
[[nodiscard]] std::string profile_text(const ProfileFile& profile);

}  // namespace voxtone::io
