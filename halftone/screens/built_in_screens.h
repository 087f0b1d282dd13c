// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pitches whose screens are made while building, by tools/make_screen, and embedded in this library.
#pragma once

#include <array>
#include <cstddef>

namespace voxtone::halftone {

struct BuiltInScreen {
    const char* name;
    std::array<double, 3> pitch_mm;  ///< x, y, z
};

inline constexpr std::array<BuiltInScreen, 3> built_in_screens{{
    {"j750-27um", {25.4 / 600, 25.4 / 300, 0.027}},  // Stratasys J750, High Mix and High Speed
    {"j750-14um", {25.4 / 600, 25.4 / 300, 0.014}},  // Stratasys J750, High Quality
    {"j55", {25.4 / 300, 25.4 / 300, 0.01875}},      // Stratasys J55
}};

}  // namespace voxtone::halftone
