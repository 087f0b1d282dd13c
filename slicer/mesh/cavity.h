// SPDX-License-Identifier: GPL-3.0-or-later
//
// A void that a body's surface shuts off from outside, and what is to become of such.
#pragma once

#include <array>
#include <cstdint>

namespace voxtone::slicer {

enum class CavityMode : std::uint8_t {
    automatic,  ///< those behind walls thinner than the coloured shell are filled
    keep,       ///< none
    fill,       ///< all, also those with an opening of some millimetres
};

struct Cavity {
    double volume_mm3 = 0;
    double wall_mm = 0;  ///< half of the void's surface is no farther from the outer surface
    std::array<double, 3> centre_mm{};
    bool filled = false;
    bool crossed = false;  ///< was to be filled and could not: its walls cross one another
};

}  // namespace voxtone::slicer
