// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/mip_pyramid.h"

//
// Levels by exact area averages. A level of even size averages pairs. Of an odd size 2k + 1 it has k texels, each of
// which covers 2 + 1/k texels of the level above: three taps with weights (k - i, k, i + 1) / (2k + 1).
#include <algorithm>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"

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

void decode_row(const std::uint8_t* texels, std::size_t width, float* out) {
    const auto& table = srgb8_to_linear();
    for (std::size_t x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) out[3 * x + c] = table[texels[4 * x + c]];
}
void decode_row(const std::uint16_t* texels, std::size_t width, float* out) {
    for (std::size_t x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) out[3 * x + c] = static_cast<float>(texels[4 * x + c]) / 65535.0f;
}
void encode_row(const float* values, std::size_t width, std::uint8_t* out) {
    for (std::size_t x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) out[4 * x + c] = linear_to_srgb8(values[3 * x + c]);
}
void encode_row(const float* values, std::size_t width, std::uint16_t* out) {
    for (std::size_t x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c)
            out[4 * x + c] = static_cast<std::uint16_t>(std::clamp(values[3 * x + c], 0.0f, 1.0f) * 65535.0f + 0.5f);
}

/// One row of width `from` to its averages of width `to`.
void narrow_row(const float* in, std::uint32_t from, std::uint32_t to, float* out) {
    for (std::uint32_t x = 0; x < to; ++x) {
        const Taps columns = taps(x, from);
        for (int c = 0; c < 3; ++c) {
            float sum = 0;
            for (std::uint32_t i = 0; i < columns.count; ++i)
                sum += columns.weight[i] * in[3 * (columns.first + i) + c];
            out[3 * x + c] = sum;
        }
    }
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
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        const Level from = levels_[l - 1], to = levels_[l];
        const std::size_t width = from.width;
        here.resize(3 * std::size_t{to.width} * to.height);
        parallel_ranges(0, to.height, 16, [&](std::size_t first, std::size_t last) {
            std::vector<float> row(3 * width), mean(3 * width);
            for (std::size_t y = first; y < last; ++y) {
                const Taps rows = taps(static_cast<std::uint32_t>(y), from.height);
                std::fill(mean.begin(), mean.end(), 0.0f);
                for (std::uint32_t j = 0; j < rows.count; ++j) {
                    const std::size_t texel = (rows.first + j) * width;
                    const float* values = row.data();
                    if (l > 1)
                        values = above.data() + 3 * texel;
                    else if (coded)
                        decode_row(srgb8_.data() + 4 * texel, width, row.data());
                    else
                        decode_row(linear16_.data() + 4 * texel, width, row.data());
                    const float weight = rows.weight[j];
                    for (std::size_t i = 0; i < 3 * width; ++i) mean[i] += weight * values[i];
                }
                float* out = here.data() + 3 * y * to.width;
                narrow_row(mean.data(), from.width, to.width, out);
                const std::size_t target = 4 * (to.first + y * to.width);
                if (coded)
                    encode_row(out, to.width, srgb8_.data() + target);
                else
                    encode_row(out, to.width, linear16_.data() + target);
            }
        });
        std::swap(above, here);
    }
    if (coded) keep_linear();
}

void MipPyramid::keep_linear() {
    const auto& table = srgb8_to_linear();
    linear16_.resize(srgb8_.size());
    parallel_ranges(0, srgb8_.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            linear16_[i] = static_cast<std::uint16_t>(table[srgb8_[i]] * 65535.0f + 0.5f);
    });
    srgb8_ = {};
}

}  // namespace voxtone::io
