// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/fill_gutters.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::io {

namespace {

constexpr std::int32_t none = -1;

/// Of each column the nearest used rows above and below bands of rows: a table of all texels would be as large as the
/// picture.
class ColumnBands {
public:
    static constexpr std::size_t rows = 32;

    explicit ColumnBands(const TexelCoverage& coverage)
        : coverage_(coverage),
          width_(coverage.width_px()),
          height_(coverage.height_px()),
          count_((height_ + rows - 1) / rows),
          above_(width_ * count_),
          below_(width_ * count_) {
        parallel_ranges(0, width_, 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t band = 0; band < count_; ++band)
                for (std::size_t x = first; x < last; ++x)
                    above_[band * width_ + x] = band == 0 ? none : last_used(band - 1, x, above_);
            for (std::size_t band = count_; band-- > 0;)
                for (std::size_t x = first; x < last; ++x)
                    below_[band * width_ + x] = band + 1 == count_ ? none : first_used(band + 1, x, below_);
        });
    }

    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::size_t end_of(std::size_t band) const { return std::min(height_, (band + 1) * rows); }

    /// For each texel of a band the row of the nearest used texel in its column (the upper one of two), or none.
    [[nodiscard]] std::vector<std::int32_t> nearest(std::size_t band) const {
        const std::size_t begin = band * rows, end = end_of(band);
        std::vector<std::int32_t> nearest((end - begin) * width_);
        for (std::size_t x = 0; x < width_; ++x) {
            std::int32_t seen = above_[band * width_ + x];
            for (std::size_t y = begin; y < end; ++y) {
                if (coverage_.used(y * width_ + x)) seen = static_cast<std::int32_t>(y);
                nearest[(y - begin) * width_ + x] = seen;
            }
            seen = below_[band * width_ + x];
            for (std::size_t y = end; y-- > begin;) {
                if (coverage_.used(y * width_ + x)) seen = static_cast<std::int32_t>(y);
                const auto row = static_cast<std::int32_t>(y);
                std::int32_t& best = nearest[(y - begin) * width_ + x];
                if (seen != none && (best == none || seen - row < row - best)) best = seen;
            }
        }
        return nearest;
    }

private:
    [[nodiscard]] std::int32_t last_used(std::size_t band, std::size_t x,
                                         const std::vector<std::int32_t>& beyond) const {
        for (std::size_t y = end_of(band); y-- > band * rows;)
            if (coverage_.used(y * width_ + x)) return static_cast<std::int32_t>(y);
        return beyond[band * width_ + x];
    }
    [[nodiscard]] std::int32_t first_used(std::size_t band, std::size_t x,
                                          const std::vector<std::int32_t>& beyond) const {
        for (std::size_t y = band * rows; y < end_of(band); ++y)
            if (coverage_.used(y * width_ + x)) return static_cast<std::int32_t>(y);
        return beyond[band * width_ + x];
    }

    const TexelCoverage& coverage_;
    std::size_t width_, height_, count_;
    std::vector<std::int32_t> above_, below_;
};

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
    const ColumnBands bands(coverage);
    const std::size_t w = image.width_px;
    parallel_for(0, bands.count(), 1, [&](std::size_t band) {
        const std::size_t begin = band * ColumnBands::rows;
        const std::vector<std::int32_t> nearest = bands.nearest(band);
        std::vector<Parabola> envelope;
        for (std::size_t y = begin; y < bands.end_of(band); ++y) {
            const std::int32_t* const of_row = nearest.data() + (y - begin) * w;
            lower_envelope(of_row, static_cast<std::int64_t>(y), static_cast<std::int64_t>(w), envelope);
            std::size_t piece = 0;
            for (std::size_t x = 0; x < w; ++x) {
                while (piece + 1 < envelope.size() && envelope[piece + 1].from <= static_cast<std::int64_t>(x)) ++piece;
                if (coverage.used(y * w + x)) continue;
                const auto column = static_cast<std::size_t>(envelope[piece].column);
                const std::size_t source = static_cast<std::size_t>(of_row[column]) * w + column;
                if (image.is_8_bit())
                    copy_texel(image.srgb8, y * w + x, source);
                else
                    copy_texel(image.linear16, y * w + x, source);
            }
        }
    });
}

}  // namespace voxtone::io
