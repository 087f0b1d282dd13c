// SPDX-License-Identifier: GPL-3.0-or-later
//
// A layer as the literals and matches of deflate (RFC 1951), found on pixels instead of bytes: the bitmap that is meant
// has 4 bytes a pixel and one filter byte (0) before each row, but it is never laid out.
//
// Long runs become matches at distance 4, as many of the longest length as fit; the stretch from the end of one row
// over the filter byte into the next becomes one match at the distance of a row. What lies between long runs (halftone)
// is matched greedily against the last 8192 pixels: candidates are the previous pixel, the latest place where the next
// 3 pixels were the same and the latest two where the next 5 to 8 were; the one with the best length for its price is
// taken. Why not zlib or libdeflate: png_layer_encoder.h.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "io/layers/layer_runs.h"

namespace voxtone::io {

/// Symbol of a distance in [1, 32768] and the bits that follow its code word.
struct DistanceSymbol {
    std::uint32_t symbol, extra, extra_bits;
};
[[nodiscard]] inline DistanceSymbol distance_symbol(std::uint32_t distance) {
    const std::uint32_t d = distance - 1;
    if (d < 2) return {d, 0, 0};
    const std::uint32_t top = static_cast<std::uint32_t>(std::bit_width(d)) - 1;
    return {2 * top + ((d >> (top - 1)) & 1), d & ((1u << (top - 1)) - 1), top - 1};
}

/// The tokens of a layer and how often each symbol occurs in them.
class MatchTokens {
public:
    static constexpr std::uint32_t pixel_tag = 0, filter_tag = 1, longest_tag = 2;
    static constexpr std::uint32_t longest = 258;

    /// Low 9 bits: a length of 3..258 bytes, or a tag. Above them: the distance in bytes of a match; the material of a
    /// pixel; the distance of matches of the longest length, whose number is the next word.
    [[nodiscard]] const std::vector<std::uint32_t>& words() const { return words_; }
    [[nodiscard]] const std::array<std::uint64_t, max_materials>& pixels() const { return pixels_; }
    [[nodiscard]] std::uint64_t filters() const { return filters_; }
    /// Per length of a match.
    [[nodiscard]] const std::array<std::uint64_t, 259>& lengths() const { return lengths_; }
    /// Per distance symbol.
    [[nodiscard]] const std::array<std::uint64_t, 30>& distances() const { return distances_; }

    void clear();
    void pixel(Material material) {
        words_.push_back(pixel_tag | static_cast<std::uint32_t>(material) << 9);
        ++pixels_[material];
    }
    void filter() {
        words_.push_back(filter_tag);
        ++filters_;
    }
    /// length in [3, 258], distance in [1, 32768].
    void match(std::uint32_t length, std::uint32_t distance) {
        words_.push_back(length | distance << 9);
        ++lengths_[length];
        ++distances_[distance_symbol(distance).symbol];
    }
    /// Any number of bytes but 1 and 2, as matches at one distance.
    void repeat(std::uint64_t bytes, std::uint32_t distance);

private:
    std::vector<std::uint32_t> words_;
    std::array<std::uint64_t, max_materials> pixels_{};
    std::uint64_t filters_ = 0;
    std::array<std::uint64_t, 259> lengths_{};
    std::array<std::uint64_t, 30> distances_{};
};

/// Finds the tokens of one layer after another; keeps its memory.
class RunMatcher {
public:
    RunMatcher();
    /// The result holds until the next call.
    [[nodiscard]] const MatchTokens& match(const LayerRuns& layer);

private:
    void begin_row(std::uint32_t y);
    void fill_row(std::span<const Run> row);
    void match_pixels(std::uint32_t first, std::uint32_t last);

    MatchTokens tokens_;
    std::uint32_t width_ = 0;
    // Pixels of the latest rows, one byte each; every row has one more before it, for its filter byte, which equals no
    // material. A slot counts them from the top of the layer.
    std::vector<std::uint8_t> window_;
    std::uint32_t window_slot_ = 0;   // slot of window_[0]
    std::uint32_t window_floor_ = 0;  // first slot that is filled in
    std::uint32_t window_end_ = 0;    // slot behind the last row filled in
    std::uint32_t row_slot_ = 0;      // slot of the current row's filter byte
    int long_key_unused_ = 16;
    // Where the next few pixels were last seen, for the longer key the last two places: the low 16 bits of the slot
    // (what is older than the reach is refused, and every find is compared).
    std::vector<std::uint16_t> latest_long_, latest_short_;
};

}  // namespace voxtone::io
