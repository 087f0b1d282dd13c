// SPDX-License-Identifier: GPL-3.0-or-later
//
// Channels of a printer's own whose colours are those of R, G, B: the primaries of sRGB under D65, each in one or two
// equal halves. What is made of such a set must look as what is made of the R, G, B set itself.
#pragma once

#include <array>
#include <vector>

#include "optics/colour/colour.h"
#include "optics/media/resins.h"

namespace voxtone::optics::testing {

/// Of each own channel: which of R, G, B it is a part of.
using Parts = std::vector<std::size_t>;
inline const Parts green_twice{0, 1, 1, 2}, all_twice{0, 0, 1, 1, 2, 2};

inline Channels split_channels(const Parts& parts) {
    const Eigen::Matrix3d xyz = xyz_from_linear_srgb_matrix();
    std::array<double, 3> count{};
    for (const std::size_t part : parts) ++count[part];
    Channels channels;
    channels.illuminant = Illuminant::d65;
    for (const std::size_t part : parts) {
        const Eigen::Vector3d weight = xyz.col(static_cast<Eigen::Index>(part)) / count[part];
        channels.xyz.push_back({weight[0], weight[1], weight[2]});
    }
    return channels;
}

/// An R, G, B set in such channels; media are equal.
inline ResinSet split_set(const ResinSet& rgb, const Parts& parts) {
    ResinSet set = rgb;
    set.channels = split_channels(parts);
    for (std::size_t r = 0; r < set.resins.size(); ++r) {
        Resin& resin = set.resins[r];
        resin.sigma_t_per_mm.clear();
        resin.albedo.clear();
        for (const std::size_t part : parts) {
            resin.sigma_t_per_mm.push_back(rgb.resins[r].sigma_t_per_mm[part]);
            resin.albedo.push_back(rgb.resins[r].albedo[part]);
        }
    }
    return set;
}

/// Channels that overlap, some of whose weights are negative; not those of any light.
inline Channels overlapping_channels() {
    const Eigen::Vector3d white = d50_white();
    Channels channels;
    channels.xyz = {{0.6, 0.2, -0.01}, {0.3, 0.5, 0.05}, {-0.1, 0.25, 0.2}, {}};
    for (std::size_t k = 0; k < 3; ++k)
        channels.xyz[3][k] =
            white[static_cast<Eigen::Index>(k)] - channels.xyz[0][k] - channels.xyz[1][k] - channels.xyz[2][k];
    return channels;
}

}  // namespace voxtone::optics::testing
