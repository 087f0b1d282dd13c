// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of each pixel is covered by ink: what set text and codes are before they have a colour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxtone::io {

struct Coverage {
    int width_px = 0, height_px = 0;
    double pixel_mm = 0;
    std::vector<std::uint8_t> ink;  ///< rows from the top; 255: all of the pixel

    [[nodiscard]] double width_mm() const { return width_px * pixel_mm; }
    [[nodiscard]] double height_mm() const { return height_px * pixel_mm; }
    [[nodiscard]] std::uint8_t at(int x, int y) const {
        return ink[std::size_t(y) * std::size_t(width_px) + std::size_t(x)];
    }
};

}  // namespace voxtone::io
