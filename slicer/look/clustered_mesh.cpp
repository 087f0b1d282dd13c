// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/clustered_mesh.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include <Eigen/Geometry>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

using Positions = std::span<const Eigen::Vector3f>;
using Triangles = std::span<const std::array<std::uint32_t, 3>>;

/// 0 to 5: the direction along an axis that a vertex's normal is nearest to.
std::vector<std::uint8_t> facings(Positions positions, Triangles triangles) {
    std::vector<Eigen::Vector3f> normals(positions.size(), Eigen::Vector3f::Zero());
    for (const auto& t : triangles) {
        const Eigen::Vector3f n = (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]);
        for (const std::uint32_t corner : t) normals[corner] += n;
    }
    std::vector<std::uint8_t> facing;
    facing.reserve(normals.size());
    for (const Eigen::Vector3f& n : normals) {
        Eigen::Index axis = 0;
        n.cwiseAbs().maxCoeff(&axis);
        facing.push_back(std::uint8_t(2 * axis + (n[axis] > 0 ? 1 : 0)));
    }
    return facing;
}

/// In order of the first vertex of each cube.
std::size_t assign(Positions positions, const std::vector<std::uint8_t>& facing, const Eigen::Vector3f& low,
                   double cube_mm, std::vector<std::uint32_t>& vertex_of) {
    std::unordered_map<std::uint64_t, std::uint32_t> cubes;
    cubes.reserve(positions.size() / 2);
    vertex_of.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Eigen::Vector3d at = (positions[i] - low).cast<double>() / cube_mm;
        std::uint64_t key = facing[i];
        for (Eigen::Index a = 0; a < 3; ++a) key = key << 20 | std::uint64_t(at[a]);
        vertex_of[i] = cubes.try_emplace(key, std::uint32_t(cubes.size())).first->second;
    }
    return cubes.size();
}

}  // namespace

ClusteredMesh clustered(Positions positions, Triangles triangles, std::size_t most_vertices, double finest_mm) {
    VOXTONE_EXPECT(most_vertices >= 1 && finest_mm > 0);
    ClusteredMesh mesh;
    if (positions.size() <= most_vertices) {
        mesh.positions_mm.assign(positions.begin(), positions.end());
        mesh.triangles.assign(triangles.begin(), triangles.end());
        mesh.vertex_of.resize(positions.size());
        std::iota(mesh.vertex_of.begin(), mesh.vertex_of.end(), 0u);
        return mesh;
    }
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
    for (const Eigen::Vector3f& p : positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    constexpr double most_cubes = 1 << 20;  // along an axis, as the key has room for
    const std::vector<std::uint8_t> facing = facings(positions, triangles);
    std::size_t count = 0;
    // A surface has as many cubes as its area has squares of them, and more where it slants.
    mesh.cube_mm = std::max(finest_mm * std::sqrt(double(positions.size()) / double(most_vertices)),
                            double((high - low).maxCoeff()) / (most_cubes - 1));
    while ((count = assign(positions, facing, low, mesh.cube_mm, mesh.vertex_of)) > most_vertices && count > 6)
        mesh.cube_mm *= 1.08;
    mesh.positions_mm.assign(count, Eigen::Vector3f::Zero());
    std::vector<float> weight(count, 0.0f);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        mesh.positions_mm[mesh.vertex_of[i]] += positions[i] - low;
        weight[mesh.vertex_of[i]] += 1;
    }
    for (std::size_t v = 0; v < count; ++v) mesh.positions_mm[v] = low + mesh.positions_mm[v] / weight[v];
    for (const auto& t : triangles) {
        const std::array<std::uint32_t, 3> now{mesh.vertex_of[t[0]], mesh.vertex_of[t[1]], mesh.vertex_of[t[2]]};
        if (now[0] != now[1] && now[1] != now[2] && now[2] != now[0]) mesh.triangles.push_back(now);
    }
    return mesh;
}

}  // namespace voxtone::slicer
