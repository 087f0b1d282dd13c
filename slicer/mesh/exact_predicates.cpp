// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/exact_predicates.h"

#include <algorithm>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

namespace voxtone::slicer {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

namespace {

Kernel::Triangle_3 triangle(const std::array<Eigen::Vector3d, 3>& t) {
    return {{t[0][0], t[0][1], t[0][2]}, {t[1][0], t[1][1], t[1][2]}, {t[2][0], t[2][1], t[2][2]}};
}

}  // namespace

bool segment_meets_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                            const std::array<Eigen::Vector3d, 3>& t) {
    const Kernel::Segment_3 segment({p[0], p[1], p[2]}, {q[0], q[1], q[2]});
    const Kernel::Triangle_3 face = triangle(t);
    return !segment.is_degenerate() && !face.is_degenerate() && CGAL::do_intersect(segment, face);
}

bool triangles_meet(const std::array<Eigen::Vector3d, 3>& a, const std::array<Eigen::Vector3d, 3>& b) {
    for (int axis = 0; axis < 3; ++axis) {  // most pairs are apart
        const auto [a0, a1] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
        const auto [b0, b1] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
        if (a1 < b0 || b1 < a0) return false;
    }
    const Kernel::Triangle_3 first = triangle(a), second = triangle(b);
    return !first.is_degenerate() && !second.is_degenerate() && CGAL::do_intersect(first, second);
}

}  // namespace voxtone::slicer
