// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/texture_baker.h"

#include <algorithm>
#include <cmath>

namespace voxtone::io {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr std::uint32_t margin = 2, size_step = 8, largest_patch = 2048;

/// A texel's number along one side; -1: nothing is there.
std::int64_t wrapped(std::int64_t i, std::int64_t size, Wrap wrap) {
    switch (wrap) {
        case Wrap::repeat:
            return ((i % size) + size) % size;
        case Wrap::mirror: {
            const std::int64_t twice = ((i % (2 * size)) + 2 * size) % (2 * size);
            return twice < size ? twice : 2 * size - 1 - twice;
        }
        case Wrap::clamp:
            return std::clamp<std::int64_t>(i, 0, size - 1);
        case Wrap::decal:
            break;
    }
    return i >= 0 && i < size ? i : -1;
}

/// Bilinear, colours weighted by their alpha.
Vector4f sample(const TexelImage& image, const Vector2f& uv, Wrap wrap_u, Wrap wrap_v) {
    const double x = double(uv.x()) * image.width_px - 0.5, y = (1 - double(uv.y())) * image.height_px - 0.5;
    if (!(std::abs(x) < 1e9 && std::abs(y) < 1e9)) return Vector4f::Zero();
    const auto i = static_cast<std::int64_t>(std::floor(x)), j = static_cast<std::int64_t>(std::floor(y));
    const auto s = static_cast<float>(x - double(i)), t = static_cast<float>(y - double(j));
    Vector3f rgb = Vector3f::Zero();
    float alpha = 0;
    for (int n = 0; n < 4; ++n) {
        const std::int64_t column = wrapped(i + (n & 1), image.width_px, wrap_u),
                           row = wrapped(j + (n >> 1), image.height_px, wrap_v);
        if (column < 0 || row < 0) continue;
        const std::size_t texel = std::size_t(row) * image.width_px + std::size_t(column);
        const float weight = (n & 1 ? s : 1 - s) * (n >> 1 ? t : 1 - t) * image.alpha(texel);
        rgb += weight * image.rgb(texel);
        alpha += weight;
    }
    if (alpha > 0) rgb /= alpha;
    return {rgb.x(), rgb.y(), rgb.z(), alpha};
}

template <class Value>
Value at(const std::array<Value, 3>& corner, float u, float v) {
    return (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
}

Vector4f colour_of(const BakedLayer& layer, std::span<const DecodedImage> images, float u, float v) {
    if (layer.image < 0) return at(layer.rgba, u, v);
    return sample(images[static_cast<std::size_t>(layer.image)].texels, at(layer.uv, u, v), layer.wrap_u, layer.wrap_v);
}

Vector3f composed(std::span<const BakedLayer> layers, std::span<const DecodedImage> images, float u, float v) {
    Vector4f rgba = Vector4f::Ones();
    for (std::size_t n = 0; n < layers.size(); ++n) {
        const Vector4f layer = colour_of(layers[n], images, u, v);
        rgba = n == 0 ? layer : lay_over(rgba, layer, layers[n].multiply);
    }
    const float alpha = std::clamp(rgba.w(), 0.0f, 1.0f);
    return (rgba.head<3>() * alpha + Vector3f::Constant(1 - alpha)).cwiseMax(0).cwiseMin(1);
}

/// Texels along the longest side of the triangle in its finest picture.
std::uint32_t patch_size(std::span<const BakedLayer> layers, std::span<const DecodedImage> images) {
    float longest = 2;
    for (const BakedLayer& layer : layers) {
        if (layer.image < 0) continue;
        const TexelImage& texels = images[static_cast<std::size_t>(layer.image)].texels;
        const Vector2f scale(static_cast<float>(texels.width_px), static_cast<float>(texels.height_px));
        for (int c = 0; c < 3; ++c) {
            const float length = (layer.uv[(c + 1) % 3] - layer.uv[c]).cwiseProduct(scale).norm();
            if (std::isfinite(length)) longest = std::max(longest, length);
        }
    }
    const auto size = static_cast<std::uint32_t>(std::min(std::ceil(longest), float(largest_patch - 2 * margin)));
    return (size + 2 * margin + size_step - 1) / size_step * size_step;
}

}  // namespace

Vector4f lay_over(const Vector4f& below, const Vector4f& layer, bool multiply) {
    if (multiply) return below.cwiseProduct(layer);
    const float alpha = layer.w() + below.w() * (1 - layer.w());
    if (alpha <= 0) return {layer.x(), layer.y(), layer.z(), 0};  // kept: finish_model says what that means
    const Vector3f rgb = (layer.head<3>() * layer.w() + below.head<3>() * below.w() * (1 - layer.w())) / alpha;
    return {rgb.x(), rgb.y(), rgb.z(), alpha};
}

bool TextureBaker::make_room(std::uint32_t size, Row& row) {
    if (row.x + size <= page_width) return true;
    const std::size_t needed = std::size_t{page_width} * size;
    if (texels_ + needed > max_texels) return false;
    if (pages_.empty() || pages_.back().height_px + size > page_height) {
        pages_.emplace_back();
        pages_.back().width_px = page_width;
    }
    TexelImage& page = pages_.back();
    row = {pages_.size() - 1, 0, page.height_px};
    page.height_px += size;
    page.srgb8.resize(4 * page.pixels(), 255);
    texels_ += needed;
    return true;
}

std::optional<TextureBaker::Patch> TextureBaker::bake(std::span<const BakedLayer> layers,
                                                      std::span<const DecodedImage> images) {
    const std::uint32_t size = patch_size(layers, images);
    if (rows_.size() <= size / size_step) rows_.resize(size / size_step + 1);
    Row& row = rows_[size / size_step];
    if (!make_room(size, row)) return std::nullopt;
    TexelImage& page = pages_[row.page];
    const auto inner = static_cast<float>(size - 2 * margin);
    for (std::uint32_t j = 0; j < size; ++j)
        for (std::uint32_t i = 0; i + j < size + margin; ++i) {
            if (i >= size) break;
            const float u = (static_cast<float>(i) + 0.5f - margin) / inner,
                        v = (static_cast<float>(j) + 0.5f - margin) / inner;
            page.set(std::size_t{row.y + j} * page_width + row.x + i, composed(layers, images, u, v));
        }
    const Vector2f corner(static_cast<float>(row.x + margin), static_cast<float>(row.y + margin));
    Patch patch{row.page, {corner, corner + Vector2f(inner, 0), corner + Vector2f(0, inner)}};
    row.x += size;
    return patch;
}

std::vector<DecodedImage> TextureBaker::take_pages() {
    std::vector<DecodedImage> images;
    for (TexelImage& page : pages_) images.emplace_back().texels = std::move(page);
    return images;
}

std::array<Vector2f, 3> TextureBaker::uv_of(const Patch& patch) const {
    const TexelImage& page = pages_[patch.page];
    std::array<Vector2f, 3> uv = patch.uv;
    for (Vector2f& place : uv)
        place = {place.x() / static_cast<float>(page.width_px), 1 - place.y() / static_cast<float>(page.height_px)};
    return uv;
}

}  // namespace voxtone::io
