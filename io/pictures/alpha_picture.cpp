// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/alpha_picture.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"

namespace voxtone::io {

namespace {

constexpr float one16 = 65535.0f;

AlphaPicture::Pixel times_alpha(const Eigen::Vector3f& rgb, float alpha) {
    AlphaPicture::Pixel pixel;
    for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint16_t>(std::lround(rgb[Eigen::Index(c)] * alpha * one16));
    pixel[3] = static_cast<std::uint16_t>(std::lround(alpha * one16));
    return pixel;
}

std::vector<AlphaPicture::Pixel> pixels_of(const TexelImage& image) {
    std::vector<AlphaPicture::Pixel> pixels(image.pixels());
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = times_alpha(image.rgb(i), image.alpha(i));
    return pixels;
}

}  // namespace

AlphaPicture::AlphaPicture(std::uint32_t width_px, std::uint32_t height_px, std::vector<Pixel> pixels) {
    VOXTONE_EXPECT(width_px > 0 && height_px > 0 && pixels.size() == std::size_t{width_px} * height_px);
    levels_.push_back({width_px, height_px, std::move(pixels)});
    add_smaller();
}

AlphaPicture::AlphaPicture(const TexelImage& image) : AlphaPicture(image.width_px, image.height_px, pixels_of(image)) {}

void AlphaPicture::add_smaller() {
    while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(levels_.back().halved());
}

Eigen::Vector4f AlphaPicture::Level::at(std::int64_t x, std::int64_t y) const {
    if (x < 0 || y < 0 || x >= std::int64_t{width} || y >= std::int64_t{height}) return Eigen::Vector4f::Zero();
    const Pixel& p = pixels[std::size_t(y) * width + std::size_t(x)];
    return Eigen::Vector4f(p[0], p[1], p[2], p[3]) / one16;
}

Eigen::Vector4f AlphaPicture::Level::bilinear(float x, float y) const {
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float u = x - 0.5f - left, v = y - 0.5f - top;
    const auto i = static_cast<std::int64_t>(left), j = static_cast<std::int64_t>(top);
    return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

AlphaPicture::Level AlphaPicture::Level::halved() const {
    Level half{(width + 1) / 2, (height + 1) / 2, {}};
    half.pixels.resize(std::size_t{half.width} * half.height);
    for (std::uint32_t y = 0; y < half.height; ++y)
        for (std::uint32_t x = 0; x < half.width; ++x)
            for (std::size_t c = 0; c < 4; ++c) {
                std::uint32_t sum = 2;  // rounds
                for (std::uint32_t b = 2 * y; b < std::min(2 * y + 2, height); ++b)
                    for (std::uint32_t a = 2 * x; a < std::min(2 * x + 2, width); ++a)
                        sum += pixels[std::size_t{b} * width + a][c];
                half.pixels[std::size_t{y} * half.width + x][c] = static_cast<std::uint16_t>(sum / 4);
            }
    return half;
}

Eigen::Vector4f AlphaPicture::sample(float x_px, float y_px, float lod) const {
    constexpr float far = 1e9f;
    if (!(std::abs(x_px) < far && std::abs(y_px) < far)) return Eigen::Vector4f::Zero();
    const float wanted = std::clamp(lod, 0.0f, float(levels_.size() - 1));
    const auto k = static_cast<std::size_t>(wanted);
    const float t = wanted - float(k), scale = std::ldexp(1.0f, -int(k));
    const Eigen::Vector4f fine = levels_[k].bilinear(x_px * scale, y_px * scale);
    if (t == 0 || k + 1 == levels_.size()) return fine;
    return (1 - t) * fine + t * levels_[k + 1].bilinear(x_px * scale / 2, y_px * scale / 2);
}

}  // namespace voxtone::io
