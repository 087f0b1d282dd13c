// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture laid on a surface, sampled in linear sRGB.
//
// Texel (i, j) of level 0 has its centre at u = (i + 1/2) / width, v = 1 - (j + 1/2) / height: (0, 0) is the bottom
// left corner. A sample is bilinear within a level and a linear blend of the two nearest levels:
//   sample(u, v, lod) = (1 - t) B_k(u, v) + t B_{k+1}(u, v),  k = floor(lod), t = lod - k,
// all in linear light, over the levels of mip_pyramid.h. Samples lie in [0, 1]. What the filter cannot see: direction.
// It is isotropic, so a texture that is squeezed in one direction is blurred in the other (see `lod`).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "io/pictures/mip_pyramid.h"

namespace voxtone::io {

/// What lies outside [0, 1]: the picture again, mirrored, its last texel, or nothing (a sample there is white, the
/// neutral factor).
enum class Wrap : std::uint8_t { repeat, mirror, clamp, decal };

/// Immutable; every member may be called from any thread.
class Texture {
public:
    /// `nearest`: below level 0.5 the nearest texel alone, as a file may ask for (pixel art).
    Texture(std::shared_ptr<const MipPyramid> pyramid, Wrap wrap_u, Wrap wrap_v, bool nearest = false);
    Texture(TexelImage image, Wrap wrap_u, Wrap wrap_v, bool nearest = false);

    /// Linear sRGB. lod <= 0 is level 0 alone and takes half the time; lod beyond the last level is the last level.
    /// A coordinate that is not finite or beyond 4e6 counts as 0.
    [[nodiscard]] Eigen::Vector3f sample(float u, float v, float lod = 0) const;

    /// The level whose texels, laid on this triangle, are as wide as `spacing_mm`: log2(spacing * s) with s the larger
    /// singular value of the map from mm on the triangle to texels, so that nothing is aliased in any direction.
    /// 0 where the triangle has no area; may be negative (magnification).
    [[nodiscard]] float lod(const std::array<Eigen::Vector2f, 3>& uv,
                            const std::array<Eigen::Vector3d, 3>& positions_mm, double spacing_mm) const;

    [[nodiscard]] std::uint32_t width_px() const { return pyramid_->levels().front().width; }
    [[nodiscard]] std::uint32_t height_px() const { return pyramid_->levels().front().height; }
    [[nodiscard]] std::size_t levels() const { return pyramid_->levels().size(); }
    [[nodiscard]] Wrap wrap_u() const { return wrap_u_; }
    [[nodiscard]] Wrap wrap_v() const { return wrap_v_; }
    [[nodiscard]] bool nearest() const { return nearest_; }
    [[nodiscard]] const std::shared_ptr<const MipPyramid>& pyramid() const { return pyramid_; }

private:
    std::shared_ptr<const MipPyramid> pyramid_;
    Wrap wrap_u_, wrap_v_;
    bool nearest_;
};

}  // namespace voxtone::io
