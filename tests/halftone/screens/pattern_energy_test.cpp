// SPDX-License-Identifier: GPL-3.0-or-later
//
// The field of a dither pattern, by its definition: every energy summed over all marked voxels, extremes looked for
// among all voxels.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <vector>

#include "base/random.h"
#include "halftone/screens/pattern_energy.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int edge = field_size, voxels = edge * edge * edge;
constexpr std::int32_t far_weight = 2, offset = 1 << 28;

/// Wider along x than the far term, as on a printer whose columns are narrow, and uneven along y and z.
std::vector<KernelRow> near_rows() {
    std::vector<KernelRow> rows;
    for (const auto& [dy, dz, peak] : {std::array{0, 0, 90'000}, std::array{-1, 0, 50'000}, std::array{18, 0, 700},
                                       std::array{2, -17, 300}, std::array{0, 1, 40'000}}) {
        KernelRow row{dy, dz, {}};
        for (int d = -20; d <= 20; ++d)
            for (int turn = 0; turn < 2; ++turn)
                row.value[std::size_t((d & (edge - 1)) + turn * edge)] = peak / (1 + std::abs(d));
        rows.push_back(row);
    }
    return rows;
}

int signed_offset(int d) { return ((d + edge / 2) & (edge - 1)) - edge / 2; }

/// energy(v) of one marked voxel u, for all v.
void add_by_definition(std::vector<std::int64_t>& energy, int u, int sign) {
    const int x = u % edge, y = u / edge % edge, z = u / (edge * edge);
    for (int v = 0; v < voxels; ++v) {
        const int dx = signed_offset(v % edge - x), dy = signed_offset(v / edge % edge - y),
                  dz = signed_offset(v / (edge * edge) - z);
        const auto shared = [](int d) { return std::max(0, overlap_box - std::abs(d)); };
        energy[std::size_t(v)] += sign * std::int64_t{far_weight} * shared(dx) * shared(dy) * shared(dz);
    }
    for (const KernelRow& row : near_rows())
        for (int dx = 0; dx < edge; ++dx) {
            const int v = (x + dx) % edge + edge * (((y + row.dy) & (edge - 1)) + edge * ((z + row.dz) & (edge - 1)));
            energy[std::size_t(v)] += sign * row.value[std::size_t(dx)];
        }
}

}  // namespace

TEST_CASE("The tightest cluster and the largest void are those of the energies' definition") {
    PatternEnergy pattern(near_rows(), far_weight, offset);
    std::vector<std::int64_t> energy(voxels, 0);
    std::set<int> marked;
    const auto expect_extremes = [&](bool highest) {
        const int least = pattern.lowest();
        std::int64_t lowest = INT64_MAX;
        for (int v = 0; v < voxels; ++v)
            if (!marked.contains(v)) lowest = std::min(lowest, energy[std::size_t(v)]);
        REQUIRE_FALSE(marked.contains(least));
        REQUIRE(energy[std::size_t(least)] == lowest);
        if (!highest) return;
        std::int64_t most = INT64_MIN;
        for (const int v : marked) most = std::max(most, energy[std::size_t(v)]);
        REQUIRE(marked.contains(pattern.highest()));
        REQUIRE(energy[std::size_t(pattern.highest())] == most);
    };
    const auto change = [&](int voxel, bool mark, bool keep_highest) {
        if (mark) {
            pattern.mark(voxel, keep_highest);
            marked.insert(voxel);
        } else {
            pattern.unmark(voxel);
            marked.erase(voxel);
        }
        add_by_definition(energy, voxel, mark ? 1 : -1);
        expect_extremes(keep_highest);
    };
    // At corners and borders of the torus, and anywhere.
    RandomStream random(3, 0);
    std::vector<int> places{0, edge - 1, voxels - 1, 7 + edge * 63, 40 + edge * (31 + edge * 63)};
    while (places.size() < 14) places.push_back(int(random.uniform() * voxels));
    for (const int voxel : places) change(voxel, true, true);
    // As it is used: the tightest cluster goes into the largest void.
    for (int move = 0; move < 6; ++move) {
        change(pattern.highest(), false, true);
        change(pattern.lowest(), true, true);
    }
    for (int more = 0; more < 4; ++more) change(pattern.lowest(), true, false);
}
