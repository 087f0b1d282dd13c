// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ranks by their definition: whichever voxel came next had the least or the most energy, summed anew over all marked
// voxels. With a Gaussian of half a voxel, whose field ends at the voxels that touch: the tile is made in a fraction of
// the time.
#include "halftone/screens/void_and_cluster.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/error.h"
#include "base/progress.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int edge = field_size, voxels = edge * edge * edge, first_marked = voxels / 10;

VoidAndClusterOptions narrow() {
    VoidAndClusterOptions options;
    options.sigma_pitches = 0.5, options.box_weight = 0;
    return options;
}

int wrapped(int x, int y, int z) {
    constexpr int mask = edge - 1;
    return (x & mask) + edge * ((y & mask) + edge * (z & mask));
}

/// Energies of what is marked, by the field of one voxel and its neighbours.
class Energies {
public:
    explicit Energies(const VoidAndClusterOptions& options) : energy_(voxels, 0) {
        PatternEnergy one = void_and_cluster_energy(options);
        const int middle = wrapped(9, 9, 9);
        one.mark(middle);
        for (int n = 0; n < 27; ++n)
            field_[std::size_t(n)] = one.at(wrapped(8 + n % 3, 8 + n / 3 % 3, 8 + n / 9)) - (n == 13 ? 1 << 30 : 0);
    }
    void add(int voxel, std::int64_t sign) {
        const int x = voxel % edge, y = voxel / edge % edge, z = voxel / (edge * edge);
        for (int n = 0; n < 27; ++n)
            energy_[std::size_t(wrapped(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1))] +=
                sign * field_[std::size_t(n)];
    }
    [[nodiscard]] std::int64_t at(int voxel) const { return energy_[std::size_t(voxel)]; }

private:
    std::array<std::int64_t, 27> field_{};
    std::vector<std::int64_t> energy_;
};

}  // namespace

TEST_CASE("Ranks go down cluster by cluster from a relaxed tenth, and up void by void") {
    const std::vector<std::uint32_t> rank = void_and_cluster(narrow());
    std::vector<int> voxel_of(voxels, -1);
    for (int v = 0; v < voxels; ++v) voxel_of[rank[std::size_t(v)]] = v;
    REQUIRE(std::ranges::count(voxel_of, -1) == 0);  // each rank once
    Energies energies(narrow());
    int marked = 0;
    const auto least_of_voids = [&] {
        std::int64_t least = INT64_MAX;
        for (int v = 0; v < voxels; ++v)
            if (int(rank[std::size_t(v)]) >= marked) least = std::min(least, energies.at(v));
        return least;
    };
    const auto most_of_marked = [&] {
        std::int64_t most = INT64_MIN;
        for (int n = 0; n < marked; ++n) most = std::max(most, energies.at(voxel_of[std::size_t(n)]));
        return most;
    };
    for (const int n : {1, 2, 3000, 20000, first_marked - 1, first_marked}) {
        CAPTURE(n);
        for (; marked < n; ++marked) energies.add(voxel_of[std::size_t(marked)], 1);
        CHECK(energies.at(voxel_of[std::size_t(n - 1)]) == most_of_marked());
    }
    // Relaxed: the tightest cluster, taken away, is the largest void again.
    const int cluster = voxel_of[first_marked - 1];
    energies.add(cluster, -1);
    CHECK(energies.at(cluster) <= least_of_voids());
    energies.add(cluster, 1);
    for (const int n : {first_marked, first_marked + 1, 60000, 150000, 262000, voxels - 1}) {
        CAPTURE(n);
        for (; marked < n; ++marked) energies.add(voxel_of[std::size_t(marked)], 1);
        CHECK(energies.at(voxel_of[std::size_t(n)]) == least_of_voids());
    }
}

TEST_CASE("Of thresholds each comes four times, the last eight times, and another seed draws others") {
    VoidAndClusterOptions options = narrow();
    options.seed = 2;
    const std::vector<std::uint16_t> threshold = void_and_cluster_thresholds(options);
    REQUIRE(threshold.size() == voxels);
    std::vector<int> times(65536, 0);
    for (const std::uint16_t t : threshold) ++times[t];
    CHECK(std::count(times.begin(), times.end(), 4) == 65534);
    CHECK((times[65534] == 8 && times[65535] == 0));
    // The lowest tenth keeps apart: of voxels drawn at random one in three or so would touch another by a face.
    int touch = 0;
    for (int v = 0; v < voxels; ++v) {
        const int x = v % edge, y = v / edge % edge, z = v / (edge * edge);
        const auto is_low = [&](int u) { return threshold[std::size_t(u)] < 6553; };
        touch +=
            is_low(v) && (is_low(wrapped(x + 1, y, z)) || is_low(wrapped(x, y + 1, z)) || is_low(wrapped(x, y, z + 1)));
    }
    CHECK(touch == 0);
}

TEST_CASE("A tile that is being made can be stopped") {
    Progress stopped;
    stopped.cancel();
    CHECK_THROWS_AS(void_and_cluster(narrow(), &stopped), Cancelled);
}
