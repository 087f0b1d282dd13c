// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where droplets of a halftone have run to before they were cured, for light paths, which see voxels one by one: with
// probability `chance` a particle belongs to a voxel that is drawn evenly from the box of `reach` voxels to each side
// of the one it is met in, else to that one. So each place holds the share 1 - s of its own voxel and the share s of
// the mean around it; the mean of the print stays what it was. What effective_medium.h makes of the same number is the
// colour of a halftone without end.
//
// `reach_mm` is a choice: about a mean free path of white resin, within which light does not tell voxels apart, so that
// s = 1 comes to Eq. 7 (tested); how far droplets of a J750 run nobody has measured here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace voxtone::optics {

struct DropletSpread {
    static constexpr double reach_mm = 0.1;

    double chance = 0;           ///< the set's dot spread s, [0, 1]
    std::array<int, 3> reach{};  ///< voxels, 0 to 15

    DropletSpread() = default;
    DropletSpread(double dot_spread, const std::array<double, 3>& pitch_mm) : chance(dot_spread) {
        for (std::size_t a = 0; a < 3; ++a)
            reach[a] = std::clamp(static_cast<int>(std::lround(reach_mm / pitch_mm[a])), 0, 15);
    }
    /// No particle belongs to a voxel that is farther away.
    [[nodiscard]] double farthest_mm() const { return chance > 0 ? 2 * reach_mm : 0; }
};

}  // namespace voxtone::optics
