// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mixture of the loaded resins as the screens read it: cumulative shares of 2^16. Voxel (i, j, k) with threshold
// t = screen(i, j, k) in [0, 65535] gets the first resin r with t < cumulative[r]; the last resin's bound is 65536 and
// not stored.
#pragma once

#include <array>
#include <cstdint>

namespace voxtone::halftone {

/// Most resins that a separation can mix (a J750 carries 6).
inline constexpr int max_resins = 8;

struct CumulativeMixture {
    /// Nondecreasing; unused and last entries are 65535 and mean "all the rest".
    std::array<std::uint16_t, max_resins> bound{};
};

/// The resin (index into the set) that threshold t selects. `resins` in [1, max_resins].
[[nodiscard]] inline int select_resin(const CumulativeMixture& mixture, std::uint16_t t, int resins) {
    int resin = 0;
    for (int r = 0; r + 1 < resins; ++r) resin += t >= mixture.bound[static_cast<std::size_t>(r)];
    return resin;
}

}  // namespace voxtone::halftone
