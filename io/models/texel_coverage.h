// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which texels of a picture the triangles of a mesh use, and the filling of the others.
//
// Between the islands of an atlas lies a background (black, often). Bilinear taps and minification at an island's
// border would pull it in as dark seams. So texels that no triangle uses take the value of the nearest used texel
// before the levels are made.
//
// A texel is used when a triangle covers its centre: whoever painted the atlas painted those, whereas texels that are
// merely touched may already hold background. Triangles thinner than a texel, or that cover no centre at all (palettes:
// all corners on one point), use every texel that they touch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "voxtone/io/pictures/texture.h"

namespace voxtone::io {

class TexelCoverage {
public:
    TexelCoverage(std::uint32_t width_px, std::uint32_t height_px);

    /// Counts a triangle in; it wraps as the texture does. Coordinates that are not finite or beyond 4e6 count as 0.
    void add(const std::array<Eigen::Vector2f, 3>& uv, Wrap wrap_u, Wrap wrap_v);

    [[nodiscard]] std::uint32_t width_px() const { return width_; }
    [[nodiscard]] std::uint32_t height_px() const { return height_; }
    [[nodiscard]] bool used(std::size_t texel) const { return used_[texel] != 0; }
    [[nodiscard]] std::size_t count_used() const;

private:
    bool mark_row(std::int64_t y, std::int64_t first, std::int64_t last, Wrap wrap_u, Wrap wrap_v);
    void mark_everything();

    std::uint32_t width_, height_;
    std::vector<std::uint8_t> used_;
    bool full_ = false;
    std::size_t marked_ = 0, marked_total_ = 0;
};

/// Gives every unused texel the colour and alpha of the used texel with the nearest centre (Euclidean, in texels).
/// Nothing changes when no texel is used.
///
/// Based on: A. Meijster, J. Roerdink, W. Hesselink, "A general algorithm for computing distance transforms in linear
/// time", 2000: nearest in the column first, then the lower envelope of parabolas along each row; exact.
void fill_gutters(TexelImage& image, const TexelCoverage& coverage);

}  // namespace voxtone::io
