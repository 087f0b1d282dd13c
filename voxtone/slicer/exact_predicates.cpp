// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/exact_predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

namespace voxtone::slicer {

bool triangles_meet(const std::array<Eigen::Vector3d, 3>& a, const std::array<Eigen::Vector3d, 3>& b) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    const auto triangle = [](const std::array<Eigen::Vector3d, 3>& t) {
        return Kernel::Triangle_3({t[0][0], t[0][1], t[0][2]}, {t[1][0], t[1][1], t[1][2]}, {t[2][0], t[2][1], t[2][2]});
    };
    const Kernel::Triangle_3 first = triangle(a), second = triangle(b);
    return !first.is_degenerate() && !second.is_degenerate() && CGAL::do_intersect(first, second);
}

}  // namespace voxtone::slicer
