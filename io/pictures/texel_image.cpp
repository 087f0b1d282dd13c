// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/texel_image.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

bool looks_premultiplied(const TexelImage& image) {
    // In eight bits, whose products rounding moves by one.
    constexpr int edge = 8, step = 1, bands = 8, band = 256 / bands;
    // Straight colours of one brightness would be four times as bright by alpha at its end of the scale as at the
    // other.
    constexpr std::size_t enough = 64, enough_of_band = 8, bands_to_compare = 3;
    constexpr double least_bright = 0.25, alike = 0.6;
    std::array<std::size_t, bands> counts{};
    std::array<double, bands> brightest_by_alpha{};
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const auto code = [&](std::size_t c) -> int {
            return image.is_8_bit() ? image.srgb8[4 * i + c]
                                    : linear_to_srgb8(static_cast<float>(image.linear16[4 * i + c]) / 65535.0f);
        };
        const int alpha = image.is_8_bit() ? image.srgb8[4 * i + 3] : image.linear16[4 * i + 3] / 257;
        if (alpha >= 255 - edge) continue;
        const int brightest = std::max({code(0), code(1), code(2)});
        if (brightest > alpha + step) return false;
        if (alpha < band) continue;  // rounding is too much of it
        const auto b = static_cast<std::size_t>(alpha / band);
        ++counts[b];
        brightest_by_alpha[b] = std::max(brightest_by_alpha[b], double(brightest) / alpha);
    }
    std::size_t between = 0, compared = 0;
    double least = 1, most = 0;
    for (std::size_t b = 0; b < bands; ++b) {
        between += counts[b];
        if (counts[b] < enough_of_band) continue;
        ++compared;
        least = std::min(least, brightest_by_alpha[b]), most = std::max(most, brightest_by_alpha[b]);
    }
    return between >= enough && compared >= bands_to_compare && most >= least_bright && least >= alike * most;
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
