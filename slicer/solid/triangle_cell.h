// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which cubic cells a triangle touches.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

namespace voxtone::slicer {

/// Whether a triangle, given from the centre of an axis-parallel cube, meets that cube, by the thirteen axes that can
/// separate them. Based on: T. Akenine-Moeller, "Fast 3D triangle-box overlap testing", 2001. Touching is meeting.
[[nodiscard]] inline bool triangle_meets_cube(const std::array<Eigen::Vector3d, 3>& p, double half) {
    const auto separates = [&](const Eigen::Vector3d& axis) {
        const double a = axis.dot(p[0]), b = axis.dot(p[1]), c = axis.dot(p[2]);
        const double reach = half * axis.cwiseAbs().sum();
        return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
    };
    for (int axis = 0; axis < 3; ++axis)
        if (separates(Eigen::Vector3d::Unit(axis))) return false;
    const std::array<Eigen::Vector3d, 3> edge{p[1] - p[0], p[2] - p[1], p[0] - p[2]};
    if (separates(edge[0].cross(edge[1]))) return false;
    for (const Eigen::Vector3d& e : edge)
        for (int axis = 0; axis < 3; ++axis)
            if (separates(Eigen::Vector3d::Unit(axis).cross(e))) return false;
    return true;
}

/// Calls visit(i, j, k) for the cells that a triangle meets, and perhaps for some beside them that it does not: cell
/// (i, j, k) is the unit cube from (i, j, k) on. Large triangles are walked along the two axes that they lie flattest
/// to, so that the work goes with their area.
template <class Visit>
void for_each_cell_of_triangle(const std::array<Eigen::Vector3d, 3>& p, Visit&& visit) {
    constexpr double margin = 1e-6;  // what touches a face touches both cells
    const Eigen::Vector3d low = p[0].cwiseMin(p[1]).cwiseMin(p[2]).array() - margin,
                          high = p[0].cwiseMax(p[1]).cwiseMax(p[2]).array() + margin;
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    int c = 0;
    normal.cwiseAbs().maxCoeff(&c);
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const bool flat = std::abs(normal[c]) > 0;
    std::array<int, 3> cell{};
    for (cell[a] = int(std::floor(low[a])); cell[a] <= int(std::floor(high[a])); ++cell[a])
        for (cell[b] = int(std::floor(low[b])); cell[b] <= int(std::floor(high[b])); ++cell[b]) {
            double from = low[c], to = high[c];
            if (flat) {
                const double tilt_a = normal[a] / normal[c], tilt_b = normal[b] / normal[c];
                const double middle = p[0][c] - tilt_a * (cell[a] + 0.5 - p[0][a]) - tilt_b * (cell[b] + 0.5 - p[0][b]);
                const double reach = (std::abs(tilt_a) + std::abs(tilt_b)) / 2 + margin;
                from = std::max(from, middle - reach), to = std::min(to, middle + reach);
            }
            for (cell[c] = int(std::floor(from)); cell[c] <= int(std::floor(to)); ++cell[c]) {
                const Eigen::Vector3d centre(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
                if (triangle_meets_cube({p[0] - centre, p[1] - centre, p[2] - centre}, 0.5 + margin))
                    visit(cell[0], cell[1], cell[2]);
            }
        }
}

}  // namespace voxtone::slicer
