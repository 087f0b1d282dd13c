// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture laid on a surface, sampled in linear sRGB.
//
// Texel (i, j) of level 0 has its centre at u = (i + 1/2) / width, v = 1 - (j + 1/2) / height: (0, 0) is the bottom
// left corner. A sample is bilinear within a level and a linear blend of the two nearest levels:
//   sample(u, v, lod) = (1 - t) B_k(u, v) + t B_{k+1}(u, v),  k = floor(lod), t = lod - k,
// all in linear light. A level is the area average of the level above it, also where sizes are odd, so that every level
// has the mean of level 0 (within its rounding: half an 8-bit sRGB code for 8-bit pictures, 2^-17 for deeper ones).
// Samples lie in [0, 1]. What the filter cannot see: direction. It is isotropic, so a texture that is squeezed in one
// direction is blurred in the other (see `lod`).
//
// Texels are kept as 16-bit linear light, of 8-bit pictures too: decoding sRGB codes by table took more than half of
// the time of a sample. The rounding is 2^-17, a fortieth of the step between the two darkest 8-bit codes. Memory: 8
// bytes a texel, times 4/3 for the levels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "voxtone/io/pictures/texel_image.h"

namespace voxtone::io {

/// What lies outside [0, 1]: the picture again, mirrored, its last texel, or nothing (a sample there is white, the
/// neutral factor).
enum class Wrap : std::uint8_t { repeat, mirror, clamp, decal };

/// The levels of one picture; shared by textures that lay it down differently.
class MipPyramid {
public:
    struct Level {
        std::uint32_t width, height;
        std::size_t first;  // texel
    };
    /// Alpha is not looked at: compose before.
    explicit MipPyramid(TexelImage image);

    [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
    /// Four values a texel, R, G, B and one that is not used; 65535 is 1.
    [[nodiscard]] const std::uint16_t* linear16(const Level& level) const { return linear16_.data() + 4 * level.first; }

private:
    void keep_linear();

    std::vector<Level> levels_;
    std::vector<std::uint8_t> srgb8_;  // of 8-bit pictures, only while the levels are made
    std::vector<std::uint16_t> linear16_;
};

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

private:
    std::shared_ptr<const MipPyramid> pyramid_;
    Wrap wrap_u_, wrap_v_;
    bool nearest_;
};

}  // namespace voxtone::io
