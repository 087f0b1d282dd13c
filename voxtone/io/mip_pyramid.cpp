// SPDX-License-Identifier: GPL-3.0-or-later
//
// Levels by exact area averages. A level of even size averages pairs. Of an odd size 2k + 1 it has k texels, each of which
// covers 2 + 1/k texels of the level above: three taps with weights (k - i, k, i + 1) / (2k + 1).
#include <algorithm>
#include <utility>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/io/texture.h"

namespace voxtone::io {

namespace {

struct Taps {
    std::uint32_t first, count;
    float weight[3];
};

Taps taps(std::uint32_t i, std::uint32_t size) {
    if (size == 1) return {0, 1, {1, 0, 0}};
    if (size % 2 == 0) return {2 * i, 2, {0.5f, 0.5f, 0}};
    const float k = static_cast<float>(size / 2), total = static_cast<float>(size);
    return {2 * i, 3, {(k - static_cast<float>(i)) / total, k / total, (static_cast<float>(i) + 1) / total}};
}

}  // namespace

MipPyramid::MipPyramid(TexelImage image) {
    VOXTONE_EXPECT(image.pixels() > 0);
    VOXTONE_EXPECT(std::max(image.srgb8.size(), image.linear16.size()) == 4 * image.pixels());
    std::size_t total = 0;
    for (std::uint32_t w = image.width_px, h = image.height_px;; w = std::max(1u, w / 2), h = std::max(1u, h / 2)) {
        levels_.push_back({w, h, total});
        total += std::size_t{w} * h;
        if (w == 1 && h == 1) break;
    }
    const bool coded = image.is_8_bit();
    srgb8_ = std::move(image.srgb8);
    linear16_ = std::move(image.linear16);
    if (coded)
        srgb8_.resize(4 * total);
    else
        linear16_.resize(4 * total);

    // Each level comes from the unrounded values of the one above, so that rounding does not add up.
    std::vector<float> above, here;
    const auto& decode = srgb8_to_linear();
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        const Level from = levels_[l - 1], to = levels_[l];
        here.assign(3 * std::size_t{to.width} * to.height, 0.0f);
        const auto value = [&](std::size_t texel, int c) {
            if (l > 1) return above[3 * texel + c];
            return coded ? decode[srgb8_[4 * texel + c]] : static_cast<float>(linear16_[4 * texel + c]) / 65535.0f;
        };
        parallel_for(0, to.height, 64, [&](std::size_t y) {
            const Taps rows = taps(static_cast<std::uint32_t>(y), from.height);
            for (std::uint32_t x = 0; x < to.width; ++x) {
                const Taps columns = taps(x, from.width);
                const std::size_t texel = y * to.width + x;
                for (int c = 0; c < 3; ++c) {
                    float sum = 0;
                    for (std::uint32_t j = 0; j < rows.count; ++j)
                        for (std::uint32_t i = 0; i < columns.count; ++i)
                            sum += rows.weight[j] * columns.weight[i] *
                                   value(std::size_t{rows.first + j} * from.width + columns.first + i, c);
                    here[3 * texel + c] = sum;
                    if (coded)
                        srgb8_[4 * (to.first + texel) + c] = linear_to_srgb8(sum);
                    else
                        linear16_[4 * (to.first + texel) + c] = static_cast<std::uint16_t>(std::clamp(sum, 0.0f, 1.0f) * 65535.0f + 0.5f);
                }
            }
        });
        std::swap(above, here);
    }
}

}  // namespace voxtone::io
