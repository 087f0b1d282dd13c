// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/up_axis.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace voxtone::slicer {

namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Of the convex hull (A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions", 1979).
double hull_area(std::vector<Vector2d> points) {
    std::sort(points.begin(), points.end(),
              [](const Vector2d& a, const Vector2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    double twice_area = 0;
    for (int side = 0; side < 2; ++side) {
        std::vector<Vector2d> chain;
        for (const Vector2d& p : points) {
            while (chain.size() > 1 && cross(chain.back() - chain[chain.size() - 2], p - chain.back()) <= 0)
                chain.pop_back();
            chain.push_back(p);
        }
        for (std::size_t i = 1; i < chain.size(); ++i) twice_area += cross(chain[i - 1], chain[i]);
        std::reverse(points.begin(), points.end());
    }
    return twice_area / 2;
}

/// The share of the bounding rectangle across `axis` that the outline of the lowest part covers.
double footing(std::span<const Eigen::Vector3d> positions, const Eigen::AlignedBox3d& box, int axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Eigen::Vector3d size = box.sizes();
    if (!(size[u] > 0 && size[v] > 0)) return 0;
    const double low = box.min()[axis] + size[axis] / 50;
    std::vector<Vector2d> lowest;
    for (const Eigen::Vector3d& p : positions)
        if (p[axis] <= low) lowest.emplace_back((p[u] - box.min()[u]) / size[u], (p[v] - box.min()[v]) / size[v]);
    return hull_area(std::move(lowest));
}

}  // namespace

bool looks_y_up(std::span<const Eigen::Vector3d> positions) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : positions) box.extend(p);
    if (positions.empty()) return false;
    const double on_y = footing(positions, box, 1), on_z = footing(positions, box, 2);
    return on_y >= 0.2 && on_y >= 2.5 * on_z;
}

bool looks_z_up_before(std::span<const Eigen::Vector3d> turned) {
    std::vector<Eigen::Vector3d> as_if_y_up;
    as_if_y_up.reserve(turned.size());
    for (const Eigen::Vector3d& p : turned) as_if_y_up.emplace_back(p.x(), -p.y(), p.z());
    return looks_y_up(as_if_y_up);
}

}  // namespace voxtone::slicer
