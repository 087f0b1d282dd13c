// SPDX-License-Identifier: GPL-3.0-or-later
//
// The default screen: a position-addressed three-dimensional blue-noise threshold for every voxel. It is a periodic
// tile of 64^3 voxels of ranks by void-and-cluster (`void_and_cluster.h`), isotropic in millimetres for one ratio of
// pitches. Thresholds depend on the voxel's global index alone, so a job may be cut in any way.
//
// Threshold t in [0, 65534]; each value occurs four times in the tile, the last eight times: 65535 is left out, because
// a bound of 65535 means "all the rest" and must be above every threshold (a pure resin has no stray voxels). In a
// field of constant colour the volume of each resin is
//   - over any cube of 64^3 voxels: as the 16-bit mixture says, within 4 of 262144 voxels;
//   - over any cube of 16^3 voxels: within 0.81 % of the cube's volume, for any number of resins and any mixture: the
//     worst case over all cubes and all intervals of thresholds, not a sample (tested, for the tiles of the build).
// Power at low frequencies (below 0.2 of one over the mean distance of a resin's voxels) is under 2 % of white noise's;
// around the x, y and z axis it is the same within 30 %.
//
// The tiles of the printers in the tree are made while building, by tools/make_screen, and serve printers whose x and y
// are exchanged as well; another ratio of pitches is made when asked for, which takes a few seconds.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "base/progress.h"

namespace voxtone::halftone {

class BlueNoiseScreen {
public:
    static constexpr int size = 64;
    static constexpr int mask = size - 1;

    /// The screen for voxels of this pitch (mm, > 0; only ratios matter, rounded to 0.5 %). Contract: finite and
    /// positive. Above a ratio of about 10 between two pitches the screen is not isotropic any more.
    explicit BlueNoiseScreen(const std::array<double, 3>& pitch_mm, const Progress* progress = nullptr);

    /// False: no tile of the build fits as it is, and this one was made or turned at run time.
    [[nodiscard]] bool built_in() const { return !made_; }

    /// The threshold of voxel (i, j, k); any integers.
    [[nodiscard]] std::uint16_t threshold(int i, int j, int k) const { return row(j, k)[i & mask]; }
    /// The 64 thresholds along x of the row (j, k): that of voxel i lies at [i & mask].
    [[nodiscard]] const std::uint16_t* row(int j, int k) const {
        return tile_ + (static_cast<std::size_t>((j & mask) + size * (k & mask)) * size);
    }

private:
    const std::uint16_t* tile_ = nullptr;
    std::shared_ptr<const std::uint16_t[]> made_;
};

/// Whether the library carries the tile for these pitches.
[[nodiscard]] bool has_built_in_screen(const std::array<double, 3>& pitch_mm);

}  // namespace voxtone::halftone
