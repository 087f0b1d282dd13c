// SPDX-License-Identifier: GPL-3.0-or-later
//
// Data sets of heterogeneous scattering (optics/monte_carlo/sampled_bssrdf.h) as files, measured or computed (format
// "voxtone-bssrdf").
//
//   8 bytes    "VTBSSRDF"
//   4 bytes    n, length of the header
//   n bytes    header, JSON:
//              {"format": "voxtone-bssrdf", "version": 1, "source": "...", "channels": "rgb" | [450, 550, ...] (nm),
//               "points": [width, height], "pitch_mm": 0.4, "radius": 10, "noise": [by channel]}
//   the rest   for each channel: `total`, then the pairs of each offset of the half window, (0, 0) first, then
//   ascending by y
//              and x:  (0, 0), (1, 0), ... (radius, 0), (-x, 1) ... (x, 1), ... with x^2 + y^2 <= radius^2;
//              each a picture of width x height numbers, rows from the top: for pairs the light per mm^2 that passes
//              from (px, py) to (px + x, py + y), or back, of one unit that entered; 0 where that point is outside.
//              `total`: of one unit that entered at (px, py), what leaves altogether.
//
// Whole numbers and floats (32 bits, IEEE 754) are little-endian. `noise`: variance of a value / the value, mm^-2: 1 /
// (paths or photons of both directions x pitch^2) for counts; 0 for values without noise. Rows of y > 0 lie below
// (pictures). Size: 4 x channels x points x (1 + offsets) bytes, 126 MB for 256 x 256 points, radius 10 (159 offsets),
// 3 channels; the file has exactly that many behind its header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "optics/media/resins.h"
#include "optics/monte_carlo/sampled_bssrdf.h"

namespace voxtone::io {

struct BssrdfFile {
    std::string source;
    optics::Channels channels;
    optics::SampledBssrdf responses;
};

/// Bytes behind the header.
[[nodiscard]] std::uint64_t bssrdf_bytes(std::uint64_t channels, std::uint64_t width, std::uint64_t height,
                                         std::uint32_t radius);

/// Largest that is read or written.
inline constexpr std::uint64_t most_bssrdf_bytes = std::uint64_t{1} << 32;

/// Throws FileError, InputError that names file and rule: sizes out of range (1 to 4096 points a side, radius 1 to 64),
/// a length that is not the one that the header implies, values that are not finite or below 0, totals above 1.02.
[[nodiscard]] BssrdfFile read_bssrdf(const std::filesystem::path& file);
/// Overwrites. Contract: as many channels as responses, sizes as above.
void write_bssrdf(const BssrdfFile& data, const std::filesystem::path& file);

}  // namespace voxtone::io
