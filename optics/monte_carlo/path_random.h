// SPDX-License-Identifier: GPL-3.0-or-later
//
// The random numbers of one light path, addressed by (seed, cell, channel, path).
//
// Philox, keyed by the seed, turns the address into 128 bits; they are the state of a generator that costs a few cycles
// a number: xoshiro128++ (D. Blackman, S. Vigna, "Scrambled linear pseudorandom number generators", ACM Trans. Math.
// Softw. 47, 2021; period 2^128 - 1, passes BigCrush). Two of 1e12 paths of 1e4 numbers overlap with probability below
// 1e-10.
#pragma once

#include <array>
#include <cstdint>

#include "base/random.h"

namespace voxtone::optics {

/// Where a path stands among all. A cell is known by its place in the viewing grid, so that a piece of a surface draws
/// the same paths as the whole.
struct PathAddress {
    std::array<std::int32_t, 3> cell{};
    std::uint32_t channel = 0;
    std::uint32_t path = 0;
};

/// The address as Philox takes it.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> path_counter(const PathAddress& at) {
    // 21 bits a coordinate.
    const std::uint64_t cell = (static_cast<std::uint64_t>(at.cell[2]) << 42) ^
                               (static_cast<std::uint64_t>(at.cell[1]) << 21) ^ static_cast<std::uint64_t>(at.cell[0]);
    return {at.path, at.channel, static_cast<std::uint32_t>(cell), static_cast<std::uint32_t>(cell >> 32)};
}

/// The state that the path's generator starts from.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> path_state(std::uint64_t seed, const PathAddress& at) {
    auto state =
        philox4x32(path_counter(at), {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
    if ((state[0] | state[1] | state[2] | state[3]) == 0) state[0] = 1;  // the one state that xoshiro never leaves
    return state;
}

class PathRandom {
public:
    PathRandom(std::uint64_t seed, const PathAddress& address) : s_(path_state(seed, address)) {}

    [[nodiscard]] std::uint32_t bits() {
        const std::uint32_t result = rotl(s_[0] + s_[3], 7) + s_[0];
        const std::uint32_t t = s_[1] << 9;
        s_[2] ^= s_[0];
        s_[3] ^= s_[1];
        s_[1] ^= s_[2];
        s_[0] ^= s_[3];
        s_[2] ^= t;
        s_[3] = rotl(s_[3], 11);
        return result;
    }
    explicit PathRandom(const std::array<std::uint32_t, 4>& state) : s_(state) {}
    [[nodiscard]] const std::array<std::uint32_t, 4>& state() const { return s_; }
    /// In [0, 1).
    [[nodiscard]] double uniform() { return unit_interval(bits()); }

private:
    static constexpr std::uint32_t rotl(std::uint32_t x, int k) { return (x << k) | (x >> (32 - k)); }
    std::array<std::uint32_t, 4> s_;
};

}  // namespace voxtone::optics
