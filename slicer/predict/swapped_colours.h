// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins that were told the wrong way round: two of them print in each other's colours, and nothing else would say so.
//
// Bitmap colours usually look like their resins. A colour is doubted where it is less than half as far from the usual
// colour of another assigned resin (printer.h) as from that of its own, and nearer by 20 CIEDE2000: more than what two
// programs take for the same resin differs by (our cyan 0 150 200 and the 0 174 239 of many printing programs: 8; our
// white 220 222 216 and 255 255 255: 9; our yellow 250 215 30 and 255 255 0: 13).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/layers/rgb.h"

namespace voxtone::slicer {

struct ToldColour {
    io::Rgb rgb{};
    std::string told;  ///< as the user called the resin
    std::string role;  ///< of the resin
};

/// "#rrggbb"
[[nodiscard]] std::string hex_code(const io::Rgb& rgb);

/// One sentence per doubted colour, beginning with its assignment. Roles without a usual colour are not looked at.
[[nodiscard]] std::vector<std::string> swapped_colours(std::span<const ToldColour> told);

}  // namespace voxtone::slicer
