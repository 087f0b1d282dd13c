// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/cell_index.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/contracts.h"

namespace voxtone::slicer {

CellIndex::CellIndex(const optics::Surface& surface, const std::array<double, 3>& pitch_mm) {
    VOXTONE_EXPECT(!surface.cells.empty());
    std::array<int, 3> largest{};
    centre_.reserve(surface.cells.size());
    for (const optics::SurfaceCell& cell : surface.cells) {
        for (std::size_t a = 0; a < 3; ++a) largest[a] = std::max(largest[a], int{cell.cell[a]});
        centre_.push_back(cell.centre_mm);
    }
    for (std::size_t a = 0; a < 3; ++a) {
        per_mm_[a] = static_cast<float>(1 / (surface.cell_voxels[a] * pitch_mm[a]));
        size_[a] = largest[a] + 1;
        blocks_[a] = (size_[a] + edge - 1) / edge;
    }
    block_.assign(static_cast<std::size_t>(blocks_[0]) * static_cast<std::size_t>(blocks_[1]) *
                      static_cast<std::size_t>(blocks_[2]),
                  -1);
    for (std::uint32_t c = 0; c < surface.cells.size(); ++c) {
        const auto& at = surface.cells[c].cell;
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x) offer({at[0] + x, at[1] + y, at[2] + z}, c);
    }
}

void CellIndex::offer(const std::array<int, 3>& place, std::uint32_t cell) {
    for (std::size_t a = 0; a < 3; ++a)
        if (place[a] < 0 || place[a] >= size_[a]) return;
    std::int32_t& block = block_[static_cast<std::size_t>(
        (place[2] / edge * blocks_[1] + place[1] / edge) * blocks_[0] + place[0] / edge)];
    if (block < 0) {
        block = static_cast<std::int32_t>(cell_.size() / (edge * edge * edge));
        cell_.resize(cell_.size() + edge * edge * edge, none);
    }
    std::uint32_t& held =
        cell_[static_cast<std::size_t>(block) * (edge * edge * edge) +
              static_cast<std::size_t>((place[2] % edge * edge + place[1] % edge) * edge + place[0] % edge)];
    const auto distance = [&](std::uint32_t c) {
        float sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const float d = centre_[c][a] - (static_cast<float>(place[a]) + 0.5f) / per_mm_[a];
            sum += d * d;
        }
        return sum;
    };
    if (held == none || distance(cell) < distance(held)) held = cell;
}

std::uint32_t CellIndex::lookup(const std::array<int, 3>& place) const {
    const std::int32_t block = block_[static_cast<std::size_t>(
        (place[2] / edge * blocks_[1] + place[1] / edge) * blocks_[0] + place[0] / edge)];
    if (block < 0) return none;
    return cell_[static_cast<std::size_t>(block) * (edge * edge * edge) +
                 static_cast<std::size_t>((place[2] % edge * edge + place[1] % edge) * edge + place[0] % edge)];
}

std::uint32_t CellIndex::at(const Eigen::Vector3f& place_mm) const {
    std::array<int, 3> place{};
    for (std::size_t a = 0; a < 3; ++a)
        place[a] = std::clamp(static_cast<int>(place_mm[static_cast<Eigen::Index>(a)] * per_mm_[a]), 0, size_[a] - 1);
    const std::uint32_t cell = lookup(place);
    return cell != none ? cell : nearest(place_mm);
}

/// Calls consider(cell) for the cells of the blocks that are `ring` blocks from `home` along one axis and no more along
/// the others.
template <class Consider>
void CellIndex::for_each_in_ring(const std::array<int, 3>& home, int ring, Consider&& consider) const {
    const auto low = [&](std::size_t a) { return std::max(home[a] - ring, 0); };
    const auto high = [&](std::size_t a) { return std::min(home[a] + ring, blocks_[a] - 1); };
    constexpr std::size_t places = std::size_t{edge} * edge * edge;
    for (int z = low(2); z <= high(2); ++z)
        for (int y = low(1); y <= high(1); ++y) {
            const bool whole_row = std::max(std::abs(z - home[2]), std::abs(y - home[1])) == ring;
            for (int x = low(0); x <= high(0); ++x) {
                if (!whole_row && std::abs(x - home[0]) != ring) continue;
                const std::int32_t block = block_[(static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks_[1]) +
                                                   static_cast<std::size_t>(y)) *
                                                      static_cast<std::size_t>(blocks_[0]) +
                                                  static_cast<std::size_t>(x)];
                if (block < 0) continue;
                const std::uint32_t* cells = cell_.data() + static_cast<std::size_t>(block) * places;
                for (std::size_t at = 0; at < places; ++at)
                    if (cells[at] != none) consider(cells[at]);
            }
        }
}

std::uint32_t CellIndex::nearest(const Eigen::Vector3f& place_mm) const {
    std::uint32_t best = 0;
    float least = std::numeric_limits<float>::max();
    const auto consider = [&](std::uint32_t c) {
        float sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const float d = centre_[c][a] - place_mm[static_cast<Eigen::Index>(a)];
            sum += d * d;
        }
        if (sum < least || (sum == least && c < best)) least = sum, best = c;
    };
    constexpr int reach = 4;
    std::array<int, 3> home{}, first{}, last{};
    for (std::size_t a = 0; a < 3; ++a) {
        const int at =
            std::clamp(static_cast<int>(place_mm[static_cast<Eigen::Index>(a)] * per_mm_[a]), 0, size_[a] - 1);
        home[a] = at / edge;
        first[a] = std::max(at - reach, 0);
        last[a] = std::min(at + reach, size_[a] - 1);
    }
    for (int z = first[2]; z <= last[2]; ++z)
        for (int y = first[1]; y <= last[1]; ++y)
            for (int x = first[0]; x <= last[0]; ++x)
                if (const std::uint32_t c = lookup({x, y, z}); c != none) consider(c);
    if (least < std::numeric_limits<float>::max()) return best;
    // Far from everything, as by walls that no voxel of air lies between: blocks of places in growing rings. What a
    // ring further out holds is no nearer than the blocks between, less a place that cells are known beyond their own.
    float shortest = std::numeric_limits<float>::max();
    int rings = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        shortest = std::min(shortest, 1 / per_mm_[a]);
        rings = std::max(rings, blocks_[a]);
    }
    for (int ring = 0; ring <= rings; ++ring) {
        const float beyond = static_cast<float>((ring - 1) * edge - 2) * shortest;
        if (beyond > 0 && least < beyond * beyond) break;
        for_each_in_ring(home, ring, consider);
    }
    return best;
}

}  // namespace voxtone::slicer
