// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which texels of a picture the triangles of a mesh use.
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

#include "io/pictures/texture.h"

namespace voxtone::io {

class TexelCoverage {
public:
    TexelCoverage(std::uint32_t width_px, std::uint32_t height_px);

    /// Counts a triangle in; it wraps as the texture does. Coordinates that are not finite or beyond 4e6 count as 0.
    void add(const std::array<Eigen::Vector2f, 3>& uv, Wrap wrap_u, Wrap wrap_v);

    [[nodiscard]] std::uint32_t width_px() const { return width_; }
    [[nodiscard]] std::uint32_t height_px() const { return height_; }
    [[nodiscard]] bool used(std::size_t texel) const { return used_[texel]; }
    [[nodiscard]] std::size_t count_used() const;

private:
    bool mark_row(std::int64_t y, std::int64_t first, std::int64_t last, Wrap wrap_u, Wrap wrap_v);
    void mark_everything();

    std::uint32_t width_, height_;
    std::vector<bool> used_;  ///< a bit a texel
    bool full_ = false;
    std::size_t marked_ = 0, marked_total_ = 0;
};

}  // namespace voxtone::io
