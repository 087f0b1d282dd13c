// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/run_matcher.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/contracts.h"

namespace voxtone::io {
namespace {

constexpr std::uint32_t longest_distance = 32768;      // RFC 1951
constexpr std::uint32_t reach = longest_distance / 4;  // pixels that any match may look back
constexpr std::uint32_t long_run = 24;                 // px; from here on a run is not searched in
constexpr std::uint8_t filter_slot = 0xff, end_slot = 0xfe;
constexpr std::uint32_t padding = 16;
constexpr std::uint32_t pixel_reach = 64;  // px searched for a single equal pixel
constexpr int long_bits = 12, short_bits = 12;
constexpr std::uint32_t block = 256;  // px looked up at once
constexpr std::uint32_t worth = 4;    // of a pixel told, against one bit of distance

std::uint64_t load(const std::uint8_t* at) {
    std::uint64_t value;
    std::memcpy(&value, at, sizeof value);
    if constexpr (std::endian::native == std::endian::big) value = __builtin_bswap64(value);
    return value;
}

/// Of the next pixels, as many as `unused` leaves of 64 bits, mixed.
std::uint32_t key_long(std::uint64_t next, int unused) {
    return static_cast<std::uint32_t>(((next << unused) * 0x9E3779B97F4A7C15u) >> (64 - long_bits));
}
/// How many pixels the long key takes: the calmer the halftone, the more, so that about one place within reach has the
/// same. Chosen on halftones of 0.8 to 2.2 bits per pixel.
int long_key_pixels(const LayerRuns& layer) {
    std::uint64_t runs = 0, pixels = 0;
    for (std::uint32_t y = 0; y < layer.rows(); y += 8)
        for (const Run run : layer.row(y))
            if (run.length < long_run) {
                ++runs;
                pixels += run.length;
            }
    if (2 * pixels < 3 * runs) return 5;
    return 2 * pixels < 5 * runs ? 6 : 8;
}

/// Of the next 3 pixels, four bits each.
std::uint32_t key_short(std::uint64_t next) {
    return static_cast<std::uint32_t>((next & 0xf) | (next >> 4 & 0xf0) | (next >> 8 & 0xf00));
}

/// How many pixels are equal at a and b, at most `limit`; `next` is what lies at a.
std::uint32_t equal_pixels(std::uint64_t next, const std::uint8_t* a, const std::uint8_t* b, std::uint32_t limit) {
    std::uint64_t difference = next ^ load(b);
    std::uint32_t n = 0;
    while (difference == 0) {
        n += 8;
        if (n >= limit) return limit;
        difference = load(a + n) ^ load(b + n);
    }
    return std::min(n + static_cast<std::uint32_t>(std::countr_zero(difference)) / 8, limit);
}

}  // namespace

void MatchTokens::clear() {
    words_.clear();
    pixels_.fill(0);
    filters_ = 0;
    lengths_.fill(0);
    distances_.fill(0);
}

void MatchTokens::repeat(std::uint64_t bytes, std::uint32_t distance) {
    if (bytes == 0) return;
    VOXTONE_DEBUG_EXPECT(bytes >= 3);
    std::uint64_t full = bytes / longest;
    std::uint32_t rest = static_cast<std::uint32_t>(bytes % longest);
    std::uint32_t before_rest = 0;
    if (rest == 1 || rest == 2) {  // no match is that short: take from the last long one
        --full;
        before_rest = longest - 3;
        rest += 3;
    }
    for (; full > 0;) {
        const std::uint32_t n = static_cast<std::uint32_t>(std::min<std::uint64_t>(full, 0xffffffffu));
        words_.push_back(longest_tag | distance << 9);
        words_.push_back(n);
        lengths_[longest] += n;
        distances_[distance_symbol(distance).symbol] += n;
        full -= n;
    }
    if (before_rest) match(before_rest, distance);
    if (rest) match(rest, distance);
}

RunMatcher::RunMatcher() : latest_long_(std::size_t{2} << long_bits), latest_short_(std::size_t{1} << short_bits) {}

void RunMatcher::begin_row(std::uint32_t y) {
    row_slot_ = y * (width_ + 1);
    const std::uint32_t needed = width_ + 1 + padding;
    if (row_slot_ != window_end_) {  // rows between were not filled in: what is older cannot be reached
        window_slot_ = window_floor_ = row_slot_;
    } else if (row_slot_ - window_slot_ + needed > window_.size()) {
        const std::uint32_t keep = std::min(reach, row_slot_ - window_floor_);
        std::memmove(window_.data(), window_.data() + (row_slot_ - keep - window_slot_), keep);
        window_slot_ = window_floor_ = row_slot_ - keep;
    }
    window_end_ = row_slot_ + width_ + 1;
}

void RunMatcher::fill_row(std::span<const Run> row) {
    std::uint8_t* at = window_.data() + (row_slot_ - window_slot_);
    *at++ = filter_slot;
    for (const Run run : row) {
        if (run.length <= 8) {
            const std::uint64_t eight = 0x0101010101010101u * run.material;
            std::memcpy(at, &eight, 8);
        } else {
            std::memset(at, run.material, run.length);
        }
        at += run.length;
    }
    std::memset(at, end_slot, padding);
}

void RunMatcher::match_pixels(std::uint32_t first, std::uint32_t last) {
    const std::uint8_t* const row = window_.data() + (row_slot_ - window_slot_);
    std::uint16_t* const latest_long = latest_long_.data();
    std::uint16_t* const latest_short = latest_short_.data();
    const std::uint32_t end = last + 1, row_slot = row_slot_, floor = window_floor_, stride = width_ + 1;
    // Division by the stride: exact since what is divided stays below 2^18 and the stride below 2^17.
    const std::uint64_t per_row = ((std::uint64_t{1} << 40) + stride - 1) / stride;
    std::array<std::uint16_t, block> long_backs, longer_backs, short_backs;
    const int unused = long_key_unused_;

    std::uint32_t slot = first + 1;  // in the row
    for (std::uint32_t from = slot; from < end; from += block) {
        // First the places where each pixel of the block and its followers were last seen, in a loop without branches.
        const std::uint32_t to = std::min(from + block, end);
        for (std::uint32_t i = from; i < to; ++i) {
            const std::uint64_t next = load(row + i);
            const auto place = static_cast<std::uint16_t>(row_slot + i);
            std::uint16_t* const at_long = latest_long + std::size_t{2} * key_long(next, unused);
            std::uint16_t& at_short = latest_short[key_short(next)];
            long_backs[i - from] = static_cast<std::uint16_t>(place - at_long[0]);
            longer_backs[i - from] = static_cast<std::uint16_t>(place - at_long[1]);
            short_backs[i - from] = static_cast<std::uint16_t>(place - at_short);
            at_long[1] = at_long[0];
            at_long[0] = at_short = place;
        }
        while (slot < to) {
            const std::uint8_t* const here = row + slot;
            const std::uint32_t limit = end - slot;
            const std::uint32_t oldest = std::min(reach, row_slot + slot - floor);
            const std::uint64_t next = load(here);
            // The best candidate in one number: its score, length and how far back. A match of no pixel is worth
            // nothing.
            auto candidate = [&](std::uint32_t back) {
                back = back - 1 >= oldest ? slot : back;  // out of reach: the filter byte's slot, which equals nothing
                const std::uint32_t length = equal_pixels(next, here, here - back, limit);
                const std::uint32_t score = 64 + worth * length - static_cast<std::uint32_t>(std::bit_width(back));
                return length > 0 ? std::uint64_t{score} << 40 | std::uint64_t{length} << 20 | back : 0;
            };
            std::uint64_t best = candidate(1);
            best = std::max(best, candidate(short_backs[slot - from]));
            best = std::max(best, candidate(long_backs[slot - from]));
            best = std::max(best, candidate(longer_backs[slot - from]));
            if (best == 0) {
                const std::uint32_t near = std::min(slot, pixel_reach);
                for (std::uint32_t back = 2; back < near && best == 0; ++back)
                    if (*(here - back) == *here) best = std::uint64_t{1} << 20 | back;
            }
            std::uint32_t length = best >> 20 & 0xfffff;
            if (length == 0) {
                tokens_.pixel(*here);
                length = 1;
            } else {
                const std::uint32_t back = best & 0xfffff;
                const auto rows = static_cast<std::uint32_t>(((back + stride - 1 - slot) * per_row) >> 40);
                const std::uint32_t distance = 4 * back - 3 * rows;
                if (length <= 64)
                    tokens_.match(4 * length, distance);
                else
                    tokens_.repeat(std::uint64_t{4} * length, distance);
            }
            slot += length;
        }
    }
}

const MatchTokens& RunMatcher::match(const LayerRuns& layer) {
    VOXTONE_EXPECT(layer.rows() == layer.height_px());
    tokens_.clear();
    width_ = layer.width_px();
    const std::uint32_t stride = 4 * width_ + 1;
    const bool rows_reach = stride <= longest_distance;
    window_.resize(std::max<std::size_t>(std::size_t{1} << 16, reach + 2 * std::size_t{width_ + 1 + padding}));
    window_slot_ = window_floor_ = window_end_ = 0;
    long_key_unused_ = 64 - 8 * long_key_pixels(layer);
    std::fill(latest_long_.begin(), latest_long_.end(), std::uint16_t{0});
    std::fill(latest_short_.begin(), latest_short_.end(), std::uint16_t{0});

    // Bytes at the end of the row before that are left to the match over the filter byte.
    std::uint32_t tail = 0;
    for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
        const auto row = layer.row(y);
        const auto above = y > 0 ? layer.row(y - 1) : std::span<const Run>();
        const bool next_over =
            rows_reach && y + 1 < layer.height_px() && layer.row(y + 1)[0].material == row[0].material;
        // The rest of the row's last run: what fits into the next match over the filter byte is left to it.
        auto end_run = [&](std::uint32_t left) {
            const std::uint32_t rest = left % MatchTokens::longest;
            const bool above_too =
                !above.empty() && above.back().material == row.back().material && rest <= 4u * above.back().length;
            if (next_over && above_too && rest <= MatchTokens::longest - 5) tail = rest;
            tokens_.repeat(left - tail, 4);
        };
        const bool plain = std::all_of(row.begin(), row.end(), [](Run run) { return run.length >= long_run; });
        if (!plain) {
            begin_row(y);
            fill_row(row);
        }
        std::uint32_t told = 0;  // px
        if (rows_reach && !above.empty() && above[0].material == row[0].material) {
            const std::uint32_t run = 4u * row[0].length;
            std::uint32_t lead = std::min({4u * above[0].length, run, MatchTokens::longest - 1 - tail});
            const std::uint32_t left = run - lead;
            if (left == 1 || left == 2) lead -= 3 - left;  // no match is that short
            tokens_.match(tail + 1 + lead, stride);
            tail = 0;
            if (row.size() == 1)
                end_run(run - lead);
            else
                tokens_.repeat(run - lead, 4);
            told = row[0].length;
        } else {
            tokens_.filter();
        }
        std::uint32_t run_begin = told;
        for (std::size_t i = told > 0 ? 1 : 0; i < row.size(); ++i) {
            const Run run = row[i];
            if (run.length >= long_run) {
                if (plain)
                    tokens_.pixel(static_cast<Material>(run.material));
                else
                    match_pixels(told, run_begin + 1);
                const std::uint32_t left = 4u * (run.length - 1u);
                if (i + 1 == row.size())
                    end_run(left);
                else
                    tokens_.repeat(left, 4);
                told = run_begin + run.length;
            }
            run_begin += run.length;
        }
        if (told < width_) match_pixels(told, width_);
    }
    VOXTONE_ENSURE(tail == 0);
    return tokens_;
}

}  // namespace voxtone::io
