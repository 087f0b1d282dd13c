// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "optics/colour/colour.h"

namespace voxtone::io {

namespace {

int floor_int(float x) {
    const int i = static_cast<int>(x);
    return i - (x < static_cast<float>(i));
}

/// Brings a coordinate into [0, 1]; false where nothing is laid.
bool fold(Wrap wrap, float& x) {
    if (!(x > -4e6f && x < 4e6f)) x = 0;
    switch (wrap) {
        case Wrap::repeat:
            x -= static_cast<float>(floor_int(x));
            return true;
        case Wrap::mirror: {
            x -= 2 * static_cast<float>(floor_int(x / 2));
            if (x > 1) x = 2 - x;
            return true;
        }
        case Wrap::clamp:
            x = std::clamp(x, 0.0f, 1.0f);
            return true;
        case Wrap::decal:
            return x >= 0 && x <= 1;
    }
    return true;
}

struct Axis {
    std::uint32_t i0, i1;
    float weight1;
};

/// The two texels around a folded coordinate. The neighbour of an edge texel is the other edge where the picture
/// repeats, else itself (which is also what its mirror image is).
Axis taps(Wrap wrap, float x, std::uint32_t size) {
    const float position = x * static_cast<float>(size) - 0.5f;
    const int i = floor_int(position);
    const int last = static_cast<int>(size) - 1;
    int i0 = i, i1 = i + 1;
    if (i0 < 0) i0 = wrap == Wrap::repeat ? last : 0;
    if (i1 > last) i1 = wrap == Wrap::repeat ? 0 : last;
    return {static_cast<std::uint32_t>(std::min(i0, last)), static_cast<std::uint32_t>(i1),
            position - static_cast<float>(i)};
}

// All channels at once; the compiler makes what the machine has of them. Same bits as one channel at a time.
using Values = float __attribute__((vector_size(16)));

/// sRGB codes as 16-bit linear light.
const std::array<float, 256> srgb8_to_linear16 = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const auto linear = static_cast<float>(optics::srgb_decode(static_cast<double>(i) / 255.0));
        table[i] = static_cast<float>(static_cast<std::uint16_t>(linear * 65535.0f + 0.5f));
    }
    return table;
}();

Values load(const std::uint16_t* texel) {
    const Values values = {static_cast<float>(texel[0]), static_cast<float>(texel[1]), static_cast<float>(texel[2]), 0};
    return values;
}
Values load(const std::uint8_t* texel) {
    const Values values = {srgb8_to_linear16[texel[0]], srgb8_to_linear16[texel[1]], srgb8_to_linear16[texel[2]], 0};
    return values;
}

template <class Value>
Eigen::Vector3f bilinear(const std::vector<Value>& texels, const MipPyramid::Level& level, const Axis& x,
                         const Axis& y) {
    const Value* const row0 = texels.data() + 3 * (level.first + std::size_t{y.i0} * level.width);
    const Value* const row1 = texels.data() + 3 * (level.first + std::size_t{y.i1} * level.width);
    const Values a = load(row0 + 3 * std::size_t{x.i0}), b = load(row0 + 3 * std::size_t{x.i1}),
                 c = load(row1 + 3 * std::size_t{x.i0}), d = load(row1 + 3 * std::size_t{x.i1});
    const Values top = a + x.weight1 * (b - a), bottom = c + x.weight1 * (d - c);
    const Values rgb = (top + y.weight1 * (bottom - top)) * (1.0f / 65535.0f);
    return {rgb[0], rgb[1], rgb[2]};
}

Eigen::Vector3f sample_level(const MipPyramid& pyramid, std::size_t l, Wrap wrap_u, Wrap wrap_v, float u, float v,
                             bool nearest) {
    const MipPyramid::Level& level = pyramid.levels()[l];
    Axis x = taps(wrap_u, u, level.width), y = taps(wrap_v, 1 - v, level.height);
    if (nearest) {
        x = {x.weight1 < 0.5f ? x.i0 : x.i1, 0, 0};
        y = {y.weight1 < 0.5f ? y.i0 : y.i1, 0, 0};
    }
    if (pyramid.is_8_bit()) return bilinear(pyramid.texels().srgb8, level, x, y);
    return bilinear(pyramid.texels().linear16, level, x, y);
}

}  // namespace

Texture::Texture(std::shared_ptr<const MipPyramid> pyramid, Wrap wrap_u, Wrap wrap_v, bool nearest)
    : pyramid_(std::move(pyramid)), wrap_u_(wrap_u), wrap_v_(wrap_v), nearest_(nearest) {
    VOXTONE_EXPECT(pyramid_ != nullptr);
}

Texture::Texture(TexelImage image, Wrap wrap_u, Wrap wrap_v, bool nearest)
    : Texture(std::make_shared<const MipPyramid>(std::move(image)), wrap_u, wrap_v, nearest) {}

Eigen::Vector3f Texture::sample(float u, float v, float lod) const {
    if (!fold(wrap_u_, u) || !fold(wrap_v_, v)) return Eigen::Vector3f::Ones();
    if (nearest_ && !(lod >= 0.5f)) return sample_level(*pyramid_, 0, wrap_u_, wrap_v_, u, v, true);
    if (!(lod > 0)) return sample_level(*pyramid_, 0, wrap_u_, wrap_v_, u, v, false);
    const std::size_t last = levels() - 1;
    if (lod >= static_cast<float>(last)) return sample_level(*pyramid_, last, wrap_u_, wrap_v_, u, v, false);
    const auto k = static_cast<std::size_t>(lod);
    const float t = lod - static_cast<float>(k);
    const Eigen::Vector3f fine = sample_level(*pyramid_, k, wrap_u_, wrap_v_, u, v, false);
    if (t == 0) return fine;
    const Eigen::Vector3f coarse = sample_level(*pyramid_, k + 1, wrap_u_, wrap_v_, u, v, false);
    return fine + t * (coarse - fine);
}

float Texture::lod(const std::array<Eigen::Vector2f, 3>& uv, const std::array<Eigen::Vector3d, 3>& positions_mm,
                   double spacing_mm) const {
    // Jacobian J = T P^-1 of texels over an orthonormal frame of the triangle; only J J^T is needed.
    const Eigen::Vector3d e1 = positions_mm[1] - positions_mm[0], e2 = positions_mm[2] - positions_mm[0];
    const Eigen::Vector3d normal = e1.cross(e2);
    const double length = e1.norm(), twice_area = normal.norm();
    if (!(length > 0) || !(twice_area > 0)) return 0;
    Eigen::Matrix2d edges_mm, edges_px;
    edges_mm << length, e1.dot(e2) / length, 0, twice_area / length;
    const Eigen::Vector2d size(width_px(), height_px());
    edges_px.col(0) = (uv[1] - uv[0]).cast<double>().cwiseProduct(size);
    edges_px.col(1) = (uv[2] - uv[0]).cast<double>().cwiseProduct(size);
    const Eigen::Matrix2d jacobian = edges_px * edges_mm.inverse();
    const Eigen::Matrix2d gram = jacobian * jacobian.transpose();
    const double half_trace = gram.trace() / 2, half_gap = std::hypot((gram(0, 0) - gram(1, 1)) / 2, gram(0, 1));
    const double stretch = std::sqrt(half_trace + half_gap);
    const double level = std::log2(stretch * spacing_mm);
    return std::isfinite(level) ? static_cast<float>(std::clamp(level, -32.0, 32.0)) : 0.0f;
}

}  // namespace voxtone::io
