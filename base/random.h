// SPDX-License-Identifier: GPL-3.0-or-later
//
// Addressed random numbers: a value is a function of (seed, stream, address) alone, never of the order in which values
// are drawn. So results carry the same bits for any number of threads and any tiling. Why not librandom123-dev, the
// authors' own: ours is constexpr, one screen long, and pinned by the same vectors.
// Based on: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011
// (Philox4x32 with 10 rounds). The constants are those of the paper; its known-answer vectors are tested.
#pragma once

#include <array>
#include <cstdint>

namespace voxtone {

/// Philox4x32-10: a keyed bijection of 128-bit counters. Period per key 2^128; passes BigCrush (paper, Sec. 5).
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                                                std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * counter[0];
        const std::uint64_t product1 = std::uint64_t{0xCD9E8D57u} * counter[2];
        counter = {
            static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
            static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
        key[0] += 0x9E3779B9u;
        key[1] += 0xBB67AE85u;
    }
    return counter;
}

/// Uniform in [0, 1) from 32 random bits; the step is 2^-32.
[[nodiscard]] constexpr double unit_interval(std::uint32_t bits) { return bits * 0x1p-32; }

/// A stream of random numbers that starts at an address (for instance a voxel or a path).
class RandomStream {
public:
    RandomStream(std::uint64_t seed, std::uint64_t address, std::uint32_t stream = 0)
        : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
          counter_{0, stream, static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32)} {}

    [[nodiscard]] std::uint32_t bits() {
        if (next_ == 4) {
            block_ = philox4x32(counter_, key_);
            ++counter_[0];
            next_ = 0;
        }
        return block_[next_++];
    }
    [[nodiscard]] double uniform() { return unit_interval(bits()); }

private:
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
    std::array<std::uint32_t, 4> block_{};
    std::uint32_t next_ = 4;
};

}  // namespace voxtone
