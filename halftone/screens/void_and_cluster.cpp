// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/screens/void_and_cluster.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "base/contracts.h"
#include "base/random.h"

namespace voxtone::halftone {
namespace {

constexpr int size = void_and_cluster_size;
static_assert(size == field_size);
constexpr int voxels = size * size * size;
constexpr double initial_share = 0.1;
/// Rows of the Gaussian are left out where even their peak is below this share of the centre.
constexpr double negligible = 1e-3;
/// In voxels. The Gaussian is negligible beyond 3.72 sigma, so it ends within 30 voxels: half the tile.
constexpr double longest_sigma = 8;
/// Marked voxels carry this on top of their energy, so that one field serves both searches: the lowest value is the
/// largest void, the highest the tightest cluster. Energies stay below it.
constexpr std::int32_t marked_offset = 1 << 30;

using Period = std::array<double, size>;

/// The Gaussian along one axis of the torus, by offset in voxels.
Period periodic_gaussian(double sigma_voxels) {
    Period value{};
    for (int d = 0; d < size; ++d)
        for (int image = -3; image <= 3; ++image) {
            const double distance = (d + image * size) / sigma_voxels;
            value[static_cast<std::size_t>(d)] += std::exp(-0.5 * distance * distance);
        }
    return value;
}

/// Offsets 0 .. 63 on the torus as -31 .. 32 (out of reach).
int signed_offset(int d) { return d <= size / 2 ? d : d - size; }

/// `count` voxels without repetition: the head of a shuffled list.
std::vector<int> random_voxels(int count, std::uint64_t seed) {
    std::vector<int> list(voxels);
    std::iota(list.begin(), list.end(), 0);
    RandomStream random(seed, 0);
    for (int n = 0; n < count; ++n) {
        const int other = n + static_cast<int>(random.uniform() * (voxels - n));
        std::swap(list[static_cast<std::size_t>(n)], list[static_cast<std::size_t>(other)]);
    }
    list.resize(static_cast<std::size_t>(count));
    return list;
}

}  // namespace

PatternEnergy void_and_cluster_energy(const VoidAndClusterOptions& options) {
    const double sigma_mm =
        options.sigma_pitches * std::cbrt(options.pitch_mm[0] * options.pitch_mm[1] * options.pitch_mm[2]);
    std::array<Period, 3> gaussian;
    double sum = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        gaussian[a] = periodic_gaussian(std::min(longest_sigma, sigma_mm / options.pitch_mm[a]));
        sum *= std::accumulate(gaussian[a].begin(), gaussian[a].end(), 0.0);
    }
    sum += options.box_weight * overlap_sum / overlap_peak;
    const double unit = 0.9 * marked_offset / sum;  // the energy of the full cube stays below the offset

    std::vector<KernelRow> near;
    for (int dz = 0; dz < size; ++dz)
        for (int dy = 0; dy < size; ++dy) {
            const double peak = gaussian[1][static_cast<std::size_t>(dy)] * gaussian[2][static_cast<std::size_t>(dz)];
            if (peak < negligible) continue;
            KernelRow row{signed_offset(dy), signed_offset(dz), {}};
            for (std::size_t x = 0; x < row.value.size(); ++x)
                row.value[x] = peak * gaussian[0][x % size] < negligible
                                   ? 0
                                   : static_cast<std::int32_t>(std::lround(unit * peak * gaussian[0][x % size]));
            near.push_back(row);
        }
    const auto far_weight = static_cast<std::int32_t>(std::lround(unit * options.box_weight / overlap_peak));
    return PatternEnergy(std::move(near), far_weight, marked_offset);
}

std::vector<std::uint32_t> void_and_cluster(const VoidAndClusterOptions& options, const Progress* progress) {
    for (double pitch : options.pitch_mm) VOXTONE_EXPECT(pitch > 0 && std::isfinite(pitch));
    VOXTONE_EXPECT(options.sigma_pitches >= 0.5 && options.sigma_pitches <= 3);
    VOXTONE_EXPECT(options.box_weight >= 0 && options.box_weight <= 1);
    const auto stop_if_asked = [&](int step) {
        if (progress && step % 4096 == 0) progress->check_cancelled();
    };
    PatternEnergy pattern = void_and_cluster_energy(options);
    const int initial = static_cast<int>(initial_share * voxels);
    for (int voxel : random_voxels(initial, options.seed)) pattern.mark(voxel);

    // Relax. Every move lowers the total energy, so it ends by itself; the bound only guards the time.
    for (int move = 0; move < 8 * initial; ++move) {
        stop_if_asked(move);
        const int cluster = pattern.highest();
        pattern.unmark(cluster);
        const int empty = pattern.lowest();
        pattern.mark(empty);
        if (empty == cluster) break;
    }
    // Ranks downward from the relaxed pattern, then back to it, then upward.
    std::vector<std::uint32_t> rank(voxels);
    std::vector<int> removed;
    for (int n = initial - 1; n >= 0; --n) {
        stop_if_asked(n);
        const int cluster = pattern.highest();
        pattern.unmark(cluster);
        rank[static_cast<std::size_t>(cluster)] = static_cast<std::uint32_t>(n);
        removed.push_back(cluster);
    }
    for (int voxel : removed) pattern.mark(voxel, false);
    for (int n = initial; n < voxels; ++n) {
        stop_if_asked(n);
        const int empty = pattern.lowest();
        pattern.mark(empty, false);
        rank[static_cast<std::size_t>(empty)] = static_cast<std::uint32_t>(n);
    }
    return rank;
}

std::vector<std::uint16_t> void_and_cluster_thresholds(const VoidAndClusterOptions& options, const Progress* progress) {
    const std::vector<std::uint32_t> rank = void_and_cluster(options, progress);
    std::vector<std::uint16_t> threshold(rank.size());
    std::transform(rank.begin(), rank.end(), threshold.begin(), [](std::uint32_t r) {
        return static_cast<std::uint16_t>(std::min<std::uint32_t>(r / (voxels / 65536), 65534));
    });
    return threshold;
}

}  // namespace voxtone::halftone
