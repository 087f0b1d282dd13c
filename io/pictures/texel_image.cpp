// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/texel_image.h"

#include <algorithm>

#include "base/parallel.h"

namespace voxtone::io {

bool looks_premultiplied(const TexelImage& image) {
    // In eight bits: of either kind of codes, whose products rounding moves by one.
    constexpr int edge = 8, step = 1;
    constexpr std::size_t enough = 64, one_of = 20;
    std::size_t between = 0, as_bright = 0;
    int least = 255, most = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const auto code = [&](std::size_t c) {
            return image.is_8_bit() ? image.srgb8[4 * i + c] : image.linear16[4 * i + c] / 257;
        };
        const int alpha = code(3), brightest = std::max({code(0), code(1), code(2)});
        if (alpha >= 255 - edge) continue;
        if (brightest > alpha + step) return false;
        if (alpha <= edge) continue;
        ++between;
        as_bright += brightest >= alpha - step;
        least = std::min(least, alpha), most = std::max(most, alpha);
    }
    return between >= enough && as_bright * one_of >= between && most - least >= 64;
}

TexelImage take_alpha(TexelImage& image) {
    TexelImage alpha{image.width_px, image.height_px, {}, std::vector<std::uint16_t>(4 * image.pixels())};
    parallel_for(0, image.pixels(), 1 << 16, [&](std::size_t i) {
        alpha.set(i, Eigen::Vector3f::Constant(image.alpha(i)));
        image.set_opaque(i);
    });
    return alpha;
}

void compose_over(TexelImage& image, const Eigen::Vector3f& under, const Eigen::Vector3f& tint, float tint_alpha) {
    const bool untinted = tint == Eigen::Vector3f::Ones() && tint_alpha == 1;
    parallel_for(0, image.pixels(), 1 << 16, [&](std::size_t i) {
        const float alpha = image.alpha(i) * tint_alpha;
        if (untinted && alpha == 1) return;
        image.set(i, Eigen::Vector3f(tint.cwiseProduct(image.rgb(i)) * alpha + under * (1 - alpha)));
    });
}

}  // namespace voxtone::io
