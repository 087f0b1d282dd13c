// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture with alpha that is laid over something else: colours in linear light times their alpha, with smaller copies
// of itself, so that a sample is what lies below a footprint of any size. Outside there is nothing.
//
// over(x, c) = s.rgb + (1 - s.alpha) c, with s the sample at x (Porter, Duff 1984, "Compositing digital images"). A
// sample is bilinear within a level and a linear blend of two levels; level k is the mean over 2^k x 2^k pixels, with
// nothing beyond the borders. Values are kept in 16 bits: rounding is 2^-17 a level.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "io/pictures/texel_image.h"

namespace voxtone::io {

/// Immutable; every member may be called from any thread.
class AlphaPicture {
public:
    /// R, G, B times alpha, and alpha; 65535 is 1.
    using Pixel = std::array<std::uint16_t, 4>;

    /// Rows from the top. Needs width_px * height_px pixels, at least one.
    AlphaPicture(std::uint32_t width_px, std::uint32_t height_px, std::vector<Pixel> pixels);
    explicit AlphaPicture(const TexelImage& image);

    [[nodiscard]] std::uint32_t width_px() const { return levels_[0].width; }
    [[nodiscard]] std::uint32_t height_px() const { return levels_[0].height; }
    /// Of level 0, rows from the top.
    [[nodiscard]] const std::vector<Pixel>& pixels() const { return levels_[0].pixels; }

    /// R, G, B times alpha, and alpha, at a place in pixels from the top left corner (pixel (0, 0) has its middle at
    /// 0.5, 0.5), for a footprint of 2^lod pixels; below 0 as 0.
    [[nodiscard]] Eigen::Vector4f sample(float x_px, float y_px, float lod = 0) const;

private:
    struct Level {
        std::uint32_t width, height;
        std::vector<Pixel> pixels;
        [[nodiscard]] Eigen::Vector4f at(std::int64_t x, std::int64_t y) const;
        [[nodiscard]] Eigen::Vector4f bilinear(float x, float y) const;
        [[nodiscard]] Level halved() const;
    };
    void add_smaller();

    std::vector<Level> levels_;
};

}  // namespace voxtone::io
