// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prefix codes of deflate (RFC 1951): optimal code lengths under a limit, canonical code words, and the header of a
// dynamic block that carries them. Why not zlib or libdeflate: png_layer_encoder.h.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace voxtone::io {

/// One code word as it goes into the bit stream: `bits` of them, first bit lowest.
struct CodeWord {
    std::uint32_t code = 0;
    std::uint32_t bits = 0;  ///< 0: the symbol does not occur
};

/// Lengths of an optimal prefix code with no word longer than `limit` bits (package-merge); 0 where the count is 0.
/// One used symbol gets length 1. Needs 2^limit >= number of used symbols.
/// Based on: L. Larmore, D. Hirschberg, "A fast algorithm for optimal length-limited Huffman codes", JACM 37(3), 1990.
[[nodiscard]] std::vector<std::uint8_t> huffman_lengths(std::span<const std::uint64_t> counts, int limit);

/// Canonical code words of RFC 1951, section 3.2.2, bits already in stream order.
[[nodiscard]] std::vector<CodeWord> canonical_code(std::span<const std::uint8_t> lengths);

/// Bits, first bit lowest, eight to a byte. `put` takes at most 56 bits at a time; room is reserved by the caller.
class BitWriter {
public:
    explicit BitWriter(std::uint8_t* out) : begin_(out), out_(out) {}

    void put(std::uint64_t bits, std::uint32_t count) {
        held_ |= bits << count_;
        count_ += count;
        std::uint64_t bytes_held = held_;
        if constexpr (std::endian::native == std::endian::big) bytes_held = __builtin_bswap64(bytes_held);
        std::memcpy(out_, &bytes_held, sizeof bytes_held);
        const std::uint32_t bytes = count_ >> 3;
        out_ += bytes;
        held_ >>= 8 * bytes;  // bytes <= 7: count_ < 8 before and count <= 56
        count_ &= 7;
    }
    void put(CodeWord word) { put(word.code, word.bits); }
    /// Fills the last byte with zeros; the number of bytes written.
    std::size_t finish() {
        if (count_) ++out_;
        held_ = count_ = 0;
        return static_cast<std::size_t>(out_ - begin_);
    }
    /// Bytes that are complete, and the eight that `put` may touch beyond them.
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(out_ - begin_); }

private:
    std::uint8_t* begin_;
    std::uint8_t* out_;
    std::uint64_t held_ = 0;
    std::uint32_t count_ = 0;
};

/// Writes the header of a dynamic block: its three leading bits and both tables of lengths (RFC 1951, section 3.2.7).
/// At most 400 bytes.
void put_dynamic_header(BitWriter& out, bool last_block, std::span<const std::uint8_t> literal_lengths,
                        std::span<const std::uint8_t> distance_lengths);

}  // namespace voxtone::io
