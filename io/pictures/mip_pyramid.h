// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture and its smaller copies. A level is the area average of the level above it, also where sizes are odd, so
// that every level has the mean of level 0 (within its rounding: half an 8-bit sRGB code for 8-bit pictures, 2^-17 for
// deeper ones).
//
// Texels are kept as 16-bit linear light, of 8-bit pictures too: decoding sRGB codes by table took more than half of
// the time of a sample. The rounding is 2^-17, a fortieth of the step between the two darkest 8-bit codes. Memory: 8
// bytes a texel, times 4/3 for the levels.
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
    /// Alpha is not looked at: compose before.
    explicit MipPyramid(TexelImage image);

    /// As `levels` and `texels` of another one gave them.
    MipPyramid(std::vector<Level> levels, std::vector<std::uint16_t> texels)
        : levels_(std::move(levels)), linear16_(std::move(texels)) {}

    [[nodiscard]] const std::vector<std::uint16_t>& texels() const { return linear16_; }
    [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
    /// Four values a texel, R, G, B and one that is not used; 65535 is 1.
    [[nodiscard]] const std::uint16_t* linear16(const Level& level) const { return linear16_.data() + 4 * level.first; }

private:
    void keep_linear();

    std::vector<Level> levels_;
    std::vector<std::uint8_t> srgb8_;  // of 8-bit pictures, only while the levels are made
    std::vector<std::uint16_t> linear16_;
};

}  // namespace voxtone::io
