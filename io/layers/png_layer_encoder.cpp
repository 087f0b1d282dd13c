// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/png_layer_encoder.h"

#include <cmath>
#include <string_view>

#include <zlib.h>

#include "base/contracts.h"
#include "io/layers/huffman_code.h"
#include "io/layers/run_matcher.h"

namespace voxtone::io {
namespace {

constexpr int end_of_block = 256;  // RFC 1951

/// Length symbol and extra bits of RFC 1951, section 3.2.5, for a match of 3..258 bytes.
struct LengthSymbol {
    std::uint32_t symbol, extra, extra_bits;
};

LengthSymbol length_symbol(std::uint32_t length) {
    if (length == 258) return {285, 0, 0};
    const std::uint32_t l = length - 3;
    if (l < 8) return {257 + l, 0, 0};
    std::uint32_t bits = 1;
    while ((l >> bits) >= 8) ++bits;
    return {257 + 4 * bits + (l >> bits), l & ((1u << bits) - 1), bits};
}

class BlockWriter {
public:
    BlockWriter(const MatchTokens& tokens, std::span<const Rgb> palette) : tokens_(tokens) {
        std::array<std::uint64_t, 286> counts{};
        counts[0] += tokens.filters();
        for (std::size_t m = 0; m < palette.size(); ++m) {
            for (const auto value : palette[m]) counts[value] += tokens.pixels()[m];
            counts[255] += tokens.pixels()[m];
        }
        counts[end_of_block] = 1;
        for (std::uint32_t length = 3; length <= 258; ++length)
            counts[length_symbol(length).symbol] += tokens.lengths()[length];
        literal_lengths_ = huffman_lengths(counts, 15);
        distance_lengths_ = huffman_lengths(tokens.distances(), 15);
        literals_ = canonical_code(literal_lengths_);
        distances_ = canonical_code(distance_lengths_);
        for (std::size_t s = 0; s < counts.size(); ++s) bits_ += counts[s] * literals_[s].bits;
        for (std::uint32_t length = 3; length <= 258; ++length) {
            const auto symbol = length_symbol(length);
            const CodeWord word = literals_[symbol.symbol];
            lengths_[length] = {word.code | symbol.extra << word.bits, word.bits + symbol.extra_bits};
            bits_ += tokens.lengths()[length] * symbol.extra_bits;
        }
        for (std::uint32_t s = 0; s < distances_.size(); ++s)
            bits_ += tokens.distances()[s] * (distances_[s].bits + (s < 4 ? 0 : s / 2 - 1));
        for (std::size_t m = 0; m < palette.size(); ++m)
            pixels_[m] = {literals_[palette[m][0]], literals_[palette[m][1]], literals_[palette[m][2]], literals_[255]};
    }

    /// Bytes that `write` needs at most, the slack of the bit writer included.
    [[nodiscard]] std::size_t room() const { return static_cast<std::size_t>(bits_ / 8) + 400 + 16; }

    /// The number of bytes written.
    std::size_t write(std::uint8_t* begin) const {
        BitWriter header(begin);
        put_dynamic_header(header, true, literal_lengths_, distance_lengths_);
        BitWriter out = header;  // its address is known to nobody, so it can live in registers
        const auto& words = tokens_.words();
        for (std::size_t i = 0; i < words.size(); ++i) {
            const std::uint32_t tag = words[i] & 511, value = words[i] >> 9;
            if (tag > MatchTokens::longest_tag) {
                put_match(out, tag, value);
            } else if (tag == MatchTokens::pixel_tag) {
                const auto& pixel = pixels_[value];
                out.put(pixel[0].code | std::uint64_t{pixel[1].code} << pixel[0].bits, pixel[0].bits + pixel[1].bits);
                out.put(pixel[2].code | std::uint64_t{pixel[3].code} << pixel[2].bits, pixel[2].bits + pixel[3].bits);
            } else if (tag == MatchTokens::filter_tag) {
                out.put(literals_[0]);
            } else {
                put_longest(out, value, words[++i]);
            }
        }
        out.put(literals_[end_of_block]);
        return out.finish();
    }

private:
    struct Word {
        std::uint64_t code;
        std::uint32_t bits;
    };

    [[nodiscard]] Word match_word(std::uint32_t length, std::uint32_t distance) const {
        const CodeWord first = lengths_[length];
        const auto symbol = distance_symbol(distance);
        const CodeWord second = distances_[symbol.symbol];
        return {first.code | std::uint64_t{second.code} << first.bits |
                    std::uint64_t{symbol.extra} << (first.bits + second.bits),
                first.bits + second.bits + symbol.extra_bits};
    }
    void put_match(BitWriter& out, std::uint32_t length, std::uint32_t distance) const {
        const Word word = match_word(length, distance);
        out.put(word.code, word.bits);
    }
    /// `count` matches of the longest length: as many at once as a `put` takes.
    void put_longest(BitWriter& out, std::uint32_t distance, std::uint32_t count) const {
        const Word word = match_word(MatchTokens::longest, distance);
        const std::uint32_t at_once = 56 / word.bits;
        if (count >= at_once) {
            std::uint64_t many = 0;
            for (std::uint32_t i = 0; i < at_once; ++i) many |= word.code << (i * word.bits);
            for (; count >= at_once; count -= at_once) out.put(many, at_once * word.bits);
        }
        for (; count > 0; --count) out.put(word.code, word.bits);
    }

    const MatchTokens& tokens_;
    std::uint64_t bits_ = 0;
    std::vector<std::uint8_t> literal_lengths_, distance_lengths_;
    std::vector<CodeWord> literals_, distances_;
    std::array<CodeWord, 259> lengths_{};
    std::array<std::array<CodeWord, 4>, max_materials> pixels_{};
};

void put_big_endian(std::vector<std::uint8_t>& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// Starts a chunk; its length is written by `end_chunk`.
std::size_t begin_chunk(std::vector<std::uint8_t>& out, std::string_view type) {
    put_big_endian(out, 0);
    const std::size_t start = out.size();
    out.insert(out.end(), type.begin(), type.end());
    return start;
}

void end_chunk(std::vector<std::uint8_t>& out, std::size_t start) {
    const std::size_t length = out.size() - start - 4;
    VOXTONE_ENSURE(length <= 0x7fffffff);
    for (std::size_t i = 0; i < 4; ++i) out[start - 4 + i] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
    put_big_endian(out, static_cast<std::uint32_t>(crc32_z(0, out.data() + start, out.size() - start)));
}

}  // namespace

std::array<std::uint32_t, 2> pixels_per_metre(std::array<double, 2> pitch_um) {
    std::array<std::uint32_t, 2> result{};
    for (std::size_t i = 0; i < 2; ++i) {
        VOXTONE_EXPECT(pitch_um[i] >= 0.001 && pitch_um[i] <= 1e6);
        result[i] = static_cast<std::uint32_t>(std::lround(1e6 / pitch_um[i]));
    }
    return result;
}

std::uint32_t adler32_of_layer(const LayerRuns& layer, std::span<const Rgb> palette) {
    // A pixel adds S to the first sum, and W plus four times the first sum to the second; n equal pixels add nS, and
    // nW + 4nA + 2n(n-1)S. Reduced once a row: with n <= 65535 no row comes near 2^64.
    constexpr std::uint64_t modulus = 65521;
    std::array<std::uint64_t, max_materials> s{}, w{};
    for (std::size_t m = 0; m < palette.size(); ++m) {
        const auto [r, g, b] = palette[m];
        s[m] = std::uint64_t{r} + g + b + 255u;
        w[m] = std::uint64_t{4} * r + 3u * g + 2u * b + 255u;
    }
    std::uint64_t first = 1, second = 0;
    for (std::uint32_t y = 0; y < layer.rows(); ++y) {
        second += first;  // the filter byte is 0
        for (const Run run : layer.row(y)) {
            const std::uint64_t n = run.length, sum = s[run.material];
            second += n * (4 * first + w[run.material]) + 2 * n * (n - 1) * sum;
            first += n * sum;
        }
        first %= modulus;
        second %= modulus;
    }
    return static_cast<std::uint32_t>(second << 16 | first);
}

PngLayerEncoder::PngLayerEncoder(std::vector<Rgb> palette, std::array<double, 2> pitch_um)
    : palette_(std::move(palette)), pixels_per_metre_(io::pixels_per_metre(pitch_um)) {
    VOXTONE_EXPECT(!palette_.empty() && palette_.size() <= max_materials);
}

std::vector<std::uint8_t> PngLayerEncoder::encode(const LayerRuns& layer) const {
    RunMatcher matcher;
    const MatchTokens& tokens = matcher.match(layer);
    for (std::size_t m = palette_.size(); m < max_materials; ++m) VOXTONE_EXPECT(tokens.pixels()[m] == 0);
    const BlockWriter block(tokens, palette_);

    std::vector<std::uint8_t> out;
    out.reserve(block.room() + 128);
    for (const int byte : {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a})
        out.push_back(static_cast<std::uint8_t>(byte));
    std::size_t chunk = begin_chunk(out, "IHDR");
    put_big_endian(out, layer.width_px());
    put_big_endian(out, layer.height_px());
    for (const int byte : {8, 6, 0, 0, 0}) out.push_back(static_cast<std::uint8_t>(byte));
    end_chunk(out, chunk);
    chunk = begin_chunk(out, "pHYs");
    put_big_endian(out, pixels_per_metre_[0]);
    put_big_endian(out, pixels_per_metre_[1]);
    out.push_back(1);
    end_chunk(out, chunk);

    chunk = begin_chunk(out, "IDAT");
    out.push_back(0x78);  // deflate, window 32768
    out.push_back(0x9c);
    const std::size_t start = out.size();
    out.resize(start + block.room());
    const std::size_t written = block.write(out.data() + start);
    VOXTONE_ENSURE(written + 8 <= block.room());
    out.resize(start + written);
    put_big_endian(out, adler32_of_layer(layer, palette_));
    end_chunk(out, chunk);
    chunk = begin_chunk(out, "IEND");
    end_chunk(out, chunk);
    return out;
}

}  // namespace voxtone::io
