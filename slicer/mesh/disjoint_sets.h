// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sets that only grow together (union-find with path halving), each known by its lowest member: what belongs together
// does not depend on the order in which it was joined.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace voxtone::slicer {

class DisjointSets {
public:
    /// 0 .. count - 1, each by itself.
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

    [[nodiscard]] std::uint32_t root(std::uint32_t n) {
        while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
        return n;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = root(a), b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace voxtone::slicer
