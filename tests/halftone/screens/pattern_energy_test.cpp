// SPDX-License-Identifier: GPL-3.0-or-later
//
// The field of a dither pattern, by its definition: every energy summed over all marked voxels, extremes looked for
// among all voxels.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <tuple>
#include <vector>

#include "base/random.h"
#include "halftone/screens/void_and_cluster.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int edge = field_size, voxels = edge * edge * edge;
constexpr std::int32_t far_weight = 2, offset = 1 << 28;

/// Wider along x than the far term, as on a printer whose columns are narrow, uneven along y and z, and as high as all
/// groups of rows.
std::vector<KernelRow> near_rows() {
    std::vector<KernelRow> rows;
    for (const auto& [dy, dz, peak] :
         {std::array{0, 0, 90'000}, std::array{-1, 0, 50'000}, std::array{18, 0, 700}, std::array{2, -17, 300},
          std::array{0, 1, 40'000}, std::array{-30, 0, 800}, std::array{25, 0, 60'000}}) {
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
    // The second lies 25 rows below the first, whose group is the last of all that it reaches.
    places.insert(places.end(), {20 + edge * (45 + edge * 20), 20 + edge * (20 + edge * 20)});
    while (places.size() < 16) places.push_back(int(random.uniform() * voxels));
    for (const int voxel : places) change(voxel, true, true);
    // As it is used: the tightest cluster goes into the largest void.
    for (int move = 0; move < 6; ++move) {
        change(pattern.highest(), false, true);
        change(pattern.lowest(), true, true);
    }
    for (int more = 0; more < 4; ++more) change(pattern.lowest(), true, false);
}

TEST_CASE("A voxel's field is round in millimetres, shared cubes added, and all together stay below the mark") {
    constexpr double mark = 1 << 30;
    // The last's sigma would be 11 thin voxels: there it is 8.
    for (const auto& [pitch_mm, sigma, weight] :
         {std::tuple{std::array{25.4 / 600, 25.4 / 300, 0.027}, 1.5, 0.1},
          std::tuple{std::array{1.0, 1.0, 1.0}, 2.0, 0.0}, std::tuple{std::array{1.0, 1.0, 0.05}, 1.5, 0.3}}) {
        VoidAndClusterOptions options;
        options.pitch_mm = pitch_mm, options.sigma_pitches = sigma, options.box_weight = weight;
        PatternEnergy pattern = void_and_cluster_energy(options);
        const int x = 60, y = 2, z = 33, middle = x + edge * (y + edge * z);
        pattern.mark(middle);
        const double unit = (pattern.at(middle) - mark) / (1 + weight),
                     sigma_mm = sigma * std::cbrt(pitch_mm[0] * pitch_mm[1] * pitch_mm[2]);
        double sum = 0, worst = 0;
        for (int v = 0; v < voxels; ++v) {
            const std::array d{signed_offset(v % edge - x), signed_offset(v / edge % edge - y),
                               signed_offset(v / (edge * edge) - z)};
            double square = 0, shared = 1;
            for (std::size_t a = 0; a < 3; ++a) {
                square += std::pow(d[a] / std::min(8.0, sigma_mm / pitch_mm[a]), 2);
                shared *= std::max(0, overlap_box - std::abs(d[a])) / double{overlap_box};
            }
            const double energy = pattern.at(v) - (v == middle ? mark : 0);
            worst = std::max(worst, std::abs(energy / unit - std::exp(-square / 2) - weight * shared));
            sum += energy;
        }
        INFO(sigma << " " << weight << ": off by " << worst << ", all together " << sum / mark << " of the mark");
        CHECK(worst < 1.2e-3);  // what is below a thousandth is left out
        CHECK(sum / mark == Approx(0.9).epsilon(0.01));
    }
}
