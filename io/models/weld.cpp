// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/weld.h"

#include <bit>
#include <limits>

namespace voxtone::io {

namespace {

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hash(const Eigen::Vector3d& p) {
    std::uint64_t h = 0x9E3779B97F4A7C15u;
    for (const double x : p) {
        h ^= std::bit_cast<std::uint64_t>(x);
        h *= 0xBF58476D1CE4E5B9u;
        h ^= h >> 29;
    }
    return h;
}

}  // namespace

void weld_positions(std::vector<Eigen::Vector3d>& positions, std::vector<std::array<std::uint32_t, 3>>& triangles) {
    const std::size_t slots = std::bit_ceil(2 * positions.size() + 2);  // open addressing, at most half full
    std::vector<std::uint32_t> table(slots, nobody), renamed(positions.size(), nobody);
    std::vector<Eigen::Vector3d> kept;
    const auto rename = [&](std::uint32_t old) {
        if (renamed[old] != nobody) return renamed[old];
        const Eigen::Vector3d p = positions[old] + Eigen::Vector3d::Zero();  // -0 + 0 = 0
        std::size_t slot = hash(p) & (slots - 1);
        while (table[slot] != nobody && kept[table[slot]] != p) slot = (slot + 1) & (slots - 1);
        if (table[slot] == nobody) {
            table[slot] = static_cast<std::uint32_t>(kept.size());
            kept.push_back(p);
        }
        return renamed[old] = table[slot];
    };
    for (auto& triangle : triangles)
        for (std::uint32_t& corner : triangle) corner = rename(corner);
    positions = std::move(kept);
}

}  // namespace voxtone::io
