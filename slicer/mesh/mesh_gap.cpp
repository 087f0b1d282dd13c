// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_gap.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/mesh/box.h"
#include "slicer/mesh/exact_predicates.h"
#include "slicer/mesh/winding_number.h"

namespace voxtone::slicer {

namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

double squared_distance(const Eigen::Vector3d& p, const Corners& t) {
    const Eigen::Vector3d w = nearest_weights(p, t[0], t[1], t[2]);
    return (w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - p).squaredNorm();
}

bool nearer_than(const Corners& a, const Corners& b, double squared_mm) {
    for (std::size_t i = 0; i < 3; ++i)
        if (squared_distance(a[i], b) < squared_mm || squared_distance(b[i], a) < squared_mm) return true;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (squared_segment_distance(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]) < squared_mm) return true;
    return triangles_meet(a, b);
}

/// A corner that triangles use; surfaces that are not near either lie apart or one lies in the other as a whole.
bool has_inside(const TriangleTree& outer, const TriangleTree& inner, const Eigen::Vector3d& shift) {
    return winding_number(outer, inner.corners(0)[0] + shift) != 0;
}

}  // namespace

double squared_segment_distance(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& q0,
                                const Eigen::Vector3d& q1) {
    // The nearest points are both inside of their segments, or one of them is an end.
    const Eigen::Vector3d p = p1 - p0, q = q1 - q0, r = p0 - q0;
    const auto from_end = [](const Eigen::Vector3d& end, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
        const double length = way.squaredNorm();
        const double at = length > 0 ? std::clamp((end - from).dot(way) / length, 0.0, 1.0) : 0;
        return (from + at * way - end).squaredNorm();
    };
    double least = std::min({from_end(p0, q0, q), from_end(p1, q0, q), from_end(q0, p0, p), from_end(q1, p0, p)});
    const double pp = p.squaredNorm(), qq = q.squaredNorm(), pq = p.dot(q), parallel = pp * qq - pq * pq;
    if (parallel > 0) {
        const double s = (pq * q.dot(r) - qq * p.dot(r)) / parallel, t = (pp * q.dot(r) - pq * p.dot(r)) / parallel;
        if (s > 0 && s < 1 && t > 0 && t < 1) least = std::min(least, (r + s * p - t * q).squaredNorm());
    }
    return least;
}

bool nearer_than(const TriangleTree& a, const TriangleTree& b, const Eigen::Vector3d& shift, double mm) {
    if (a.empty() || b.empty()) return false;
    if (a.triangles().size() > b.triangles().size()) return nearer_than(b, a, -shift, mm);
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(mm);
    Eigen::AlignedBox3d box = bounding_box(b.positions(), b.triangles());
    box = {box.min() + shift - around, box.max() + shift + around};
    if (!box.intersects(bounding_box(a.positions(), a.triangles()))) return false;
    std::atomic<bool> near{false};
    parallel_for(0, a.triangles().size(), 1024, [&](std::size_t t) {
        if (near.load(std::memory_order_relaxed)) return;
        const Corners mine = a.corners(static_cast<std::uint32_t>(t));
        Eigen::AlignedBox3d here;
        for (const Eigen::Vector3d& corner : mine) here.extend(corner);
        if (!box.intersects(here)) return;
        std::vector<std::uint32_t> candidates;
        b.overlapping(here.min() - shift - around, here.max() - shift + around, candidates);
        for (const std::uint32_t candidate : candidates) {
            Corners other = b.corners(candidate);
            for (Eigen::Vector3d& corner : other) corner += shift;
            if (nearer_than(mine, other, mm * mm)) {
                near.store(true, std::memory_order_relaxed);
                return;
            }
        }
    });
    return near || has_inside(a, b, shift) || has_inside(b, a, -shift);
}

}  // namespace voxtone::slicer
