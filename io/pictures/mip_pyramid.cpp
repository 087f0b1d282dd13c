// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/mip_pyramid.h"

//
// Levels by exact area averages. A level of even size averages pairs. Of an odd size 2k + 1 it has k texels, each of
// which covers 2 + 1/k texels of the level above: three taps with weights (k - i, k, i + 1) / (2k + 1).
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

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
    for (std::size_t i = 0; i < 3 * width; ++i) out[i] = table[texels[i]];
}
void decode_row(const std::uint16_t* texels, std::size_t width, float* out) {
    for (std::size_t i = 0; i < 3 * width; ++i) out[i] = static_cast<float>(texels[i]) / 65535.0f;
}
void encode_row(const float* values, std::size_t width, std::uint8_t* out) {
    for (std::size_t i = 0; i < 3 * width; ++i) out[i] = linear_to_srgb8(values[i]);
}
void encode_row(const float* values, std::size_t width, std::uint16_t* out) {
    for (std::size_t i = 0; i < 3 * width; ++i)
        out[i] = static_cast<std::uint16_t>(std::clamp(values[i], 0.0f, 1.0f) * 65535.0f + 0.5f);
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

/// Rows of a level, of which so many are given from `first`, to row `y` of the next one.
void average_rows(const std::vector<const float*>& rows, const Taps& taps, const MipPyramid::Level& from,
                  const MipPyramid::Level& to, std::vector<float>& mean, float* out) {
    mean.assign(3 * std::size_t{from.width}, 0.0f);
    for (std::uint32_t j = 0; j < taps.count; ++j) {
        const float weight = taps.weight[j];
        const float* const values = rows[j];
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += weight * values[i];
    }
    narrow_row(mean.data(), from.width, to.width, out);
}

/// The levels below one whose rows come from the top. Each is made of unrounded values of the one above, so that
/// rounding does not add up, and keeps the last rows of it alone.
template <class Value>
class LowerLevels {
public:
    LowerLevels(const std::vector<MipPyramid::Level>& levels, std::size_t first, Value* texels)
        : levels_(levels), texels_(texels), states_(levels.size()) {
        for (std::size_t l = first; l < levels.size(); ++l)
            for (auto& row : states_[l].last) row.resize(3 * std::size_t{levels[l].width});
    }

    /// Row `y` of level `l`; it is stored, and what is complete with it is made.
    void push(std::size_t l, std::uint32_t y, const float* row) {
        const MipPyramid::Level& from = levels_[l];
        encode_row(row, from.width, texels_ + 3 * (from.first + std::size_t{y} * from.width));
        if (l + 1 == levels_.size()) return;
        State& state = states_[l];
        std::copy_n(row, 3 * std::size_t{from.width}, state.last[y % kept].begin());
        const MipPyramid::Level& to = levels_[l + 1];
        for (; state.next < to.height; ++state.next) {
            const Taps rows = taps(state.next, from.height);
            if (rows.first + rows.count > y + 1) return;
            std::vector<const float*> given;
            for (std::uint32_t j = 0; j < rows.count; ++j) given.push_back(state.last[(rows.first + j) % kept].data());
            std::vector<float> made(3 * std::size_t{to.width});
            average_rows(given, rows, from, to, state.mean, made.data());
            push(l + 1, state.next, made.data());
        }
    }

private:
    static constexpr std::size_t kept = 3;  ///< as many as an average has taps
    struct State {
        std::array<std::vector<float>, kept> last;
        std::vector<float> mean;
        std::uint32_t next = 0;  ///< row of the level below
    };
    const std::vector<MipPyramid::Level>& levels_;
    Value* texels_;
    std::vector<State> states_;
};

/// Four values a texel become three, in place; the levels below are appended.
template <class Value>
void make_levels(std::vector<Value>& texels, const std::vector<MipPyramid::Level>& levels) {
    const std::size_t pixels = texels.size() / 4;
    for (std::size_t i = 1; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) texels[3 * i + c] = texels[4 * i + c];
    const MipPyramid::Level top = levels.front(), last = levels.back();
    texels.resize(3 * (last.first + 1));
    if (levels.size() == 1) return;
    const MipPyramid::Level next = levels[1];
    constexpr std::size_t rows_at_once = 64;
    std::vector<float> band(3 * std::size_t{next.width} * rows_at_once);
    LowerLevels<Value> lower(levels, 1, texels.data());
    for (std::size_t begin = 0; begin < next.height; begin += rows_at_once) {
        const std::size_t end = std::min<std::size_t>(begin + rows_at_once, next.height);
        parallel_ranges(begin, end, 8, [&](std::size_t first, std::size_t past) {
            std::vector<std::vector<float>> decoded(3, std::vector<float>(3 * std::size_t{top.width}));
            std::vector<const float*> given{decoded[0].data(), decoded[1].data(), decoded[2].data()};
            std::vector<float> mean;
            for (std::size_t y = first; y < past; ++y) {
                const Taps rows = taps(static_cast<std::uint32_t>(y), top.height);
                for (std::uint32_t j = 0; j < rows.count; ++j)
                    decode_row(texels.data() + 3 * std::size_t{rows.first + j} * top.width, top.width,
                               decoded[j].data());
                average_rows(given, rows, top, next, mean, band.data() + 3 * (y - begin) * next.width);
            }
        });
        for (std::size_t y = begin; y < end; ++y)
            lower.push(1, static_cast<std::uint32_t>(y), band.data() + 3 * (y - begin) * next.width);
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
    texels_ = {std::move(image.srgb8), std::move(image.linear16)};
    if (is_8_bit())
        make_levels(texels_.srgb8, levels_);
    else
        make_levels(texels_.linear16, levels_);
}

}  // namespace voxtone::io
