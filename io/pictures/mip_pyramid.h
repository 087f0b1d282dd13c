// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture and its smaller copies. A level is the area average of the level above it, also where sizes are odd, so
// that every level has the mean of level 0 (within its rounding: half an 8-bit sRGB code for 8-bit pictures, 2^-17 for
// deeper ones).
//
// Texels of 8-bit pictures stay in their codes and are decoded when they are sampled, to 16-bit linear light: the
// rounding is 2^-17, a fortieth of the step between the two darkest codes. Deeper ones are kept so. Memory: 3 or 6
// bytes a texel, times 4/3 for the levels, and no more than the picture's own 4 or 8 while they are made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "io/pictures/texel_image.h"

namespace voxtone::io {

/// The levels of one picture; shared by textures that lay it down differently.
class MipPyramid {
public:
    struct Level {
        std::uint32_t width, height;
        std::size_t first;  // texel
    };
    /// Three values a texel, R, G, B, of all levels; one of the two is empty.
    struct Texels {
        std::vector<std::uint8_t> srgb8;
        std::vector<std::uint16_t> linear16;  ///< 65535 is 1

        bool operator==(const Texels&) const = default;
        [[nodiscard]] std::size_t count() const { return (srgb8.size() + linear16.size()) / 3; }
    };
    /// Alpha is not looked at: compose before.
    explicit MipPyramid(TexelImage image);

    /// As `levels` and `texels` of another one gave them.
    MipPyramid(std::vector<Level> levels, Texels texels) : levels_(std::move(levels)), texels_(std::move(texels)) {}

    [[nodiscard]] const Texels& texels() const { return texels_; }
    [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
    [[nodiscard]] bool is_8_bit() const { return !texels_.srgb8.empty(); }

private:
    std::vector<Level> levels_;
    Texels texels_;
};

}  // namespace voxtone::io
