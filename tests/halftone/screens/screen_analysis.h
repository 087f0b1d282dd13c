// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the tests of screens share: exact worst errors of counts in cubes, and spectra in cycles per mm.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace voxtone::halftone::test {

/// A tile of 64^3 thresholds, x fastest.
using Tile = std::vector<std::uint16_t>;

/// max over all cubes of 16^3 voxels (of the periodic tile) and all intervals [a, b) of thresholds of
/// |voxels in the interval - 4096 (b - a) / 65536|, in voxels, rounded up by less than 2. This bounds every resin of
/// every mixture in every cube.
[[nodiscard]] double worst_cube_error(const Tile& tile);

/// The same thresholds in random order.
[[nodiscard]] Tile shuffled(Tile tile, std::uint64_t seed);

/// Power of the indicator of thresholds in [first, last), relative to white noise of the same share (mean 1 by
/// Parseval), averaged over the frequencies nu (cycles per mm) for which `selected(nu)`.
struct Spectrum {
    Spectrum(const Tile& tile, const std::array<double, 3>& pitch_mm, int first, int last);
    [[nodiscard]] double mean(const std::function<bool(const std::array<double, 3>&)>& selected) const;

private:
    std::array<double, 3> step_;  ///< cycles per mm of one bin
    std::vector<float> power_;
};

}  // namespace voxtone::halftone::test
