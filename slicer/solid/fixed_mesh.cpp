// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/fixed_mesh.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"

namespace voxtone::slicer {

FixedMesh::FixedMesh(const SolidMesh& mesh, const VoxelGrid& grid) : triangles(mesh.triangles) {
    for (int a = 0; a < 3; ++a) VOXTONE_EXPECT(grid.size[a] > 0 && grid.pitch_mm[a] > 0);

    // In voxels, so that centres are integers.
    std::vector<Eigen::Vector3d> scaled;
    scaled.reserve(mesh.positions_mm.size());
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    Eigen::Vector3d high(grid.size[0], grid.size[1], grid.size[2]);
    for (const Eigen::Vector3d& p : mesh.positions_mm) {
        scaled.emplace_back((p - grid.origin_mm).cwiseQuotient(grid.pitch_mm).array() - 0.5);
        low = low.cwiseMin(scaled.back());
        high = high.cwiseMax(scaled.back());
    }
    // Differences below 2^30, so that edge functions stay below 2^61.
    const double extent = (high - low).maxCoeff() + 2;
    VOXTONE_EXPECT(extent < 1 << 22);
    while (std::ldexp(extent, fraction_bits) > 0x1p30) --fraction_bits;

    vertices.reserve(scaled.size());
    for (const Eigen::Vector3d& p : scaled) {
        Vertex v;
        for (int a = 0; a < 3; ++a) v[a] = static_cast<std::int32_t>(std::llround(std::ldexp(p[a], fraction_bits)));
        vertices.push_back(v);
    }

    const int buckets = (grid.size[2] + bucket_layers - 1) / bucket_layers;
    // From the layer below the lowest corner (also where that lies on a centre) to the layer above the highest.
    const auto buckets_of = [&](const std::array<std::uint32_t, 3>& t) {
        const auto [z0, z1] = std::minmax({vertices[t[0]][2], vertices[t[1]][2], vertices[t[2]][2]});
        const int k0 = std::max(int(ceil_div<std::int64_t>(z0, std::int64_t{1} << fraction_bits)) - 1, 0),
                  k1 = std::min((z1 >> fraction_bits) + 1, grid.size[2] - 1);
        return k0 > k1 ? std::pair{0, 0} : std::pair{k0 / bucket_layers, k1 / bucket_layers + 1};
    };
    bucket_begin.assign(std::size_t(buckets) + 1, 0);
    for (const auto& t : triangles) {
        const auto [first, last] = buckets_of(t);
        for (int b = first; b < last; ++b) ++bucket_begin[std::size_t(b) + 1];
    }
    for (int b = 0; b < buckets; ++b) bucket_begin[std::size_t(b) + 1] += bucket_begin[std::size_t(b)];
    bucket_triangles.resize(bucket_begin.back());
    std::vector<std::size_t> next(bucket_begin.begin(), bucket_begin.end() - 1);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto [first, last] = buckets_of(triangles[t]);
        for (int b = first; b < last; ++b) bucket_triangles[next[std::size_t(b)]++] = static_cast<std::uint32_t>(t);
    }
}

}  // namespace voxtone::slicer
