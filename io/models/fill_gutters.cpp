// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/fill_gutters.h"

#include <cstdint>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::io {

namespace {

constexpr std::int32_t none = -1;

/// For each texel the row of the nearest used texel in its column (the upper one of two), or none.
std::vector<std::int32_t> nearest_in_column(const TexelCoverage& coverage) {
    const std::size_t w = coverage.width_px(), h = coverage.height_px();
    std::vector<std::int32_t> nearest(w * h);
    parallel_ranges(0, w, 256, [&](std::size_t first, std::size_t last) {
        std::vector<std::int32_t> seen(last - first, none);
        for (std::size_t y = 0; y < h; ++y)
            for (std::size_t x = first; x < last; ++x) {
                if (coverage.used(y * w + x)) seen[x - first] = static_cast<std::int32_t>(y);
                nearest[y * w + x] = seen[x - first];
            }
        seen.assign(last - first, none);
        for (std::size_t y = h; y-- > 0;)
            for (std::size_t x = first; x < last; ++x) {
                if (coverage.used(y * w + x)) seen[x - first] = static_cast<std::int32_t>(y);
                const std::int32_t below = seen[x - first], row = static_cast<std::int32_t>(y);
                std::int32_t& best = nearest[y * w + x];
                if (below != none && (best == none || below - row < row - best)) best = below;
            }
    });
    return nearest;
}

struct Parabola {
    std::int64_t column, height;  // height: squared distance within the column
    std::int64_t from;            // first x at which it is the lowest
};

/// Lower envelope of (x - column)^2 + height over x in [0, w).
void lower_envelope(const std::int32_t* nearest, std::int64_t y, std::int64_t w, std::vector<Parabola>& envelope) {
    envelope.clear();
    for (std::int64_t x = 0; x < w; ++x) {
        if (nearest[x] == none) continue;
        const std::int64_t dy = y - nearest[x], height = dy * dy;
        std::int64_t from = 0;
        while (!envelope.empty()) {
            const Parabola& top = envelope.back();
            // first x' with (x'-x)^2 + height < (x'-column)^2 + top.height; floor of the crossing, plus one
            const std::int64_t numerator = x * x + height - top.column * top.column - top.height;
            const std::int64_t denominator = 2 * (x - top.column);
            std::int64_t crossing = numerator / denominator;
            if (numerator % denominator < 0) --crossing;
            from = crossing + 1;
            if (from > top.from) break;
            envelope.pop_back();
            from = 0;
        }
        if (from < w) envelope.push_back({x, height, from < 0 ? 0 : from});
    }
}

template <class Value>
void copy_texel(std::vector<Value>& values, std::size_t to, std::size_t from) {
    for (std::size_t c = 0; c < 4; ++c) values[4 * to + c] = values[4 * from + c];
}

}  // namespace

void fill_gutters(TexelImage& image, const TexelCoverage& coverage) {
    VOXTONE_EXPECT(image.width_px == coverage.width_px() && image.height_px == coverage.height_px());
    const std::size_t count = coverage.count_used();
    if (count == 0 || count == image.pixels()) return;
    const std::vector<std::int32_t> nearest = nearest_in_column(coverage);
    const std::size_t w = image.width_px;
    parallel_ranges(0, image.height_px, 32, [&](std::size_t first, std::size_t last) {
        std::vector<Parabola> envelope;
        for (std::size_t y = first; y < last; ++y) {
            lower_envelope(nearest.data() + y * w, static_cast<std::int64_t>(y), static_cast<std::int64_t>(w),
                           envelope);
            std::size_t piece = 0;
            for (std::size_t x = 0; x < w; ++x) {
                while (piece + 1 < envelope.size() && envelope[piece + 1].from <= static_cast<std::int64_t>(x)) ++piece;
                if (coverage.used(y * w + x)) continue;
                const auto column = static_cast<std::size_t>(envelope[piece].column);
                const std::size_t source = static_cast<std::size_t>(nearest[y * w + column]) * w + column;
                if (image.is_8_bit())
                    copy_texel(image.srgb8, y * w + x, source);
                else
                    copy_texel(image.linear16, y * w + x, source);
            }
        }
    });
}

}  // namespace voxtone::io
