// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/winding_number.h"

#include <cmath>
#include <limits>
#include <optional>

#include "slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

// Crossings of the ray p + t e_axis, t > 0, with one triangle: +1 where it leaves through the front. Nothing where the
// ray meets an edge as far as doubles can tell.
std::optional<int> crossing(const Vector3d& p, int axis, const std::array<Vector3d, 3>& corner) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double e[3];
    for (int c = 0; c < 3; ++c) {
        const Vector3d &a = corner[c], &b = corner[(c + 1) % 3];
        const double left = (b[u] - a[u]) * (p[v] - a[v]), right = (b[v] - a[v]) * (p[u] - a[u]);
        e[c] = left - right;
        if (std::abs(e[c]) <= 1e-13 * (std::abs(left) + std::abs(right))) e[c] = 0;
    }
    const bool front = e[0] >= 0 && e[1] >= 0 && e[2] >= 0, back = e[0] <= 0 && e[1] <= 0 && e[2] <= 0;
    if (!front && !back) return 0;
    if (e[0] == 0 || e[1] == 0 || e[2] == 0) return std::nullopt;
    // e[c] weighs the corner opposite to edge c.
    const double sum = e[0] + e[1] + e[2];
    const double along =
        (e[1] * (corner[0][axis] - p[axis]) + e[2] * (corner[1][axis] - p[axis]) + e[0] * (corner[2][axis] - p[axis])) /
        sum;
    return along > 0 ? (front ? 1 : -1) : 0;
}

}  // namespace

int winding_number(const TriangleTree& tree, const Vector3d& p, WorkBudget* work) {
    std::vector<std::uint32_t> near;
    std::array<std::optional<int>, 3> seen;
    for (int axis = 0; axis < 3; ++axis) {
        Vector3d end = p;
        end[axis] = std::numeric_limits<double>::infinity();
        near.clear();
        tree.overlapping(p, end, near);
        if (work) work->spend(near.size() + 1);
        seen[axis] = 0;
        for (const std::uint32_t t : near) {
            const std::optional<int> one = crossing(p, axis, tree.corners(t));
            if (!one) {
                seen[axis] = std::nullopt;
                break;
            }
            *seen[axis] += *one;
        }
        for (int before = 0; before < axis; ++before)
            if (seen[axis] && seen[axis] == seen[before]) return *seen[axis];
    }
    if (work) work->spend(4 * tree.triangles().size());
    return static_cast<int>(std::lround(winding_number(tree.positions(), tree.triangles(), p)));
}

}  // namespace voxtone::slicer
