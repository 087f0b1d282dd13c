// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/seen_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxtone::slicer {

namespace {

constexpr std::uint32_t most_along = 4096;

std::uint32_t points_along(double mm, double spacing_mm) {
    return std::uint32_t(std::clamp(std::ceil(mm / spacing_mm) + 1, 2.0, double(most_along)));
}

/// x and y in steps of the grid, z the depth.
void draw_triangle(const std::array<Eigen::Vector3d, 3>& p, io::DepthMap& map) {
    const Eigen::Vector2d a = p[0].head<2>(), b = p[1].head<2>(), c = p[2].head<2>();
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(area) < 1e-12) return;  // seen edge on
    const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const auto first = [](double v) { return std::int64_t(std::ceil(std::max(v - 1e-9, 0.0))); };
    const auto last = [](double v, std::uint32_t points) {
        return std::int64_t(std::floor(std::min(v + 1e-9, double(points - 1))));
    };
    if (!(high.minCoeff() >= -1e-9)) return;
    constexpr double rounding = 1e-9;
    for (std::int64_t j = first(low.y()); j <= last(high.y(), map.rows); ++j)
        for (std::int64_t i = first(low.x()); i <= last(high.x(), map.columns); ++i) {
            const Eigen::Vector2d q(static_cast<double>(i), static_cast<double>(j));
            const double of_b = ((q.x() - a.x()) * (c.y() - a.y()) - (q.y() - a.y()) * (c.x() - a.x())) / area;
            const double of_c = ((b.x() - a.x()) * (q.y() - a.y()) - (b.y() - a.y()) * (q.x() - a.x())) / area;
            const double of_a = 1 - of_b - of_c;
            if (of_a < -rounding || of_b < -rounding || of_c < -rounding) continue;
            float& nearest = map.depth_mm[std::size_t(j) * map.columns + std::size_t(i)];
            nearest = std::min(nearest, float(of_a * p[0].z() + of_b * p[1].z() + of_c * p[2].z()));
        }
}

}  // namespace

io::DepthMap depth_below(const MarkFrame& frame, const SolidMesh& body, double spacing_mm) {
    io::DepthMap map;
    map.columns = points_along(frame.width_mm, spacing_mm);
    map.rows = points_along(frame.height_mm, spacing_mm);
    map.depth_mm.assign(std::size_t{map.columns} * map.rows, std::numeric_limits<float>::infinity());
    const double per_mm_x = (map.columns - 1) / frame.width_mm, per_mm_y = (map.rows - 1) / frame.height_mm;
    const auto seen = [&](std::uint32_t vertex) -> Eigen::Vector3d {
        const Eigen::Vector3d offset = body.positions_mm[vertex] - frame.corner_mm;
        return {frame.axes.right.dot(offset) * per_mm_x, frame.axes.up.dot(offset) * per_mm_y,
                -frame.axes.out.dot(offset)};
    };
    for (const auto& triangle : body.triangles)
        draw_triangle({seen(triangle[0]), seen(triangle[1]), seen(triangle[2])}, map);
    return map;
}

}  // namespace voxtone::slicer
