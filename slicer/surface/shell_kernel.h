// SPDX-License-Identifier: GPL-3.0-or-later
//
// The inner loops of the surface shell: distances from the voxels of a block to a handful of triangles, rows of eight
// voxels at a time. Not for use outside the surface shell.
//
// A triangle in a frame near a block (origin within a few blocks' width, single precision): with n its unit normal, u_e
// the unit direction of edge e and m_e = n x u_e the inward normal of the edge in the triangle's plane,
//     h = n.p + h0,   s_e = m_e.p + s0_e,   before_e = -u_e.p + before0_e,   after_e = u_e.p + after0_e
// are the height over the plane, the signed distance to the edge's line, and how far p lies before the edge's start and
// behind its end. The squared distance is h^2 where the foot lies inside (all s_e >= 0), else
//     h^2 + min_e (s_e^2 + max(before_e, after_e, 0)^2).
// Every term is small near the triangle however large the triangle is, so single precision holds 1e-7 of the distances.
// Edge 0 is the longest; "inside" asks in addition that the foot lies between its ends, without which a sliver would
// reach beyond its tips. The same bits on every instruction set: no fused operations, no reassociation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace voxtone::slicer::shell_kernel {

constexpr int row_voxels = 8;
constexpr int max_rows = 128;

struct LocalTriangle {
    // The seven linear functions h, s_0..2, u_0.p .. u_2.p, by coefficient; the last lane pads.
    std::array<float, 8> x, y, z, constant;
    std::array<float, 3> before, after;      // before0_e, after0_e
    std::array<float, 3> length;             // of the edges
    std::array<float, 3> inverse_length;     // 0 where the length is
    std::array<float, 3> inverse_height;     // over edge e; 0 for slivers, whose points are taken along edge 0
    std::array<std::array<float, 2>, 3> uv;  // what is interpolated, at the start corners of edges 0, 1, 2
    bool sliver;
};

/// A triangle seen from `centre`; uv belongs to the corners a, b, c.
[[nodiscard]] LocalTriangle make_local(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                       const std::array<Eigen::Vector2f, 3>& uv, const Eigen::Vector3d& centre);

/// The voxel centres of a block in the triangles' frame: x by lane, y and z by row.
struct BlockPoints {
    alignas(32) std::array<float, row_voxels> x;
    alignas(32) std::array<float, max_rows> y, z;
    int rows = 0;
};

/// What is sought, per voxel; row-major, eight to a row.
struct BlockResult {
    alignas(64) std::array<float, max_rows * row_voxels> distance2;  // least of all triangles
    alignas(64) std::array<float, max_rows * row_voxels> chosen2;    // of the chosen triangle, within the tie tolerance
    alignas(64) std::array<std::int32_t, max_rows * row_voxels> slot;  // the chosen triangle
    alignas(64) std::array<float, max_rows * row_voxels> distance, u, v;
};

/// Squared distances of a triangle from eight points (x, y, z lists of eight).
void distances2(const LocalTriangle& triangle, const float* x, const float* y, const float* z, float* out);

/// The nearest of `triangles` for every voxel of the rows where bits[row] is not zero. Triangles are tried in order; a
/// later one is taken only if its squared distance is less than (1 - 4e-6) of the earlier one's less 1e-8 mm^2: ties go
/// to the first. Clears the bits of voxels whose squared distance is above limit2; returns whether any are left.
bool nearest(const LocalTriangle* const* triangles, std::size_t count, const BlockPoints& points, float limit2,
             std::uint8_t* bits, BlockResult& result);

/// Distance and interpolated (u, v) for the voxels of shell[row], from the triangles chosen.
void finish(const LocalTriangle* const* triangles, const BlockPoints& points, const std::uint8_t* shell,
            BlockResult& result);

/// For tests: instruction sets this machine has, and a choice of one of them; -1 returns to the best.
[[nodiscard]] int instruction_sets();
void choose_instruction_set(int index);

}  // namespace voxtone::slicer::shell_kernel
