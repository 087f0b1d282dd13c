// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/sides_seen.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/random.h"
#include "slicer/mesh/mesh_boundary.h"

namespace voxtone::slicer {

namespace {

Side side_of(const Eigen::Vector3d& direction) {
    constexpr double above = std::numbers::sqrt2 / 2, below = -0.2588190451;  // sines of 45 and -15 degrees
    if (direction.z() > above) return Side::top;
    if (direction.z() < below) return Side::bottom;
    if (std::abs(direction.x()) > std::abs(direction.y())) return direction.x() > 0 ? Side::right : Side::left;
    return direction.y() > 0 ? Side::back : Side::front;
}

/// q.
double share_of(Side side) { return side == Side::bottom ? SidesSeen::from_below : 1; }

/// Direction k of a cell, by the cosine law about its normal.
Eigen::Vector3d look_out(const Eigen::Vector3d& normal, std::size_t k, double turned) {
    const double golden = std::numbers::phi - 1,
                 u = (static_cast<double>(k) + 0.5) / static_cast<double>(SidesSeen::directions),
                 turn = 2 * std::numbers::pi * (golden * static_cast<double>(k) + turned);
    const Eigen::Vector3d across = normal.unitOrthogonal(), along = normal.cross(across);
    return std::sqrt(1 - u) * normal + std::sqrt(u) * (std::cos(turn) * across + std::sin(turn) * along);
}

Eigen::Vector3d vector_from(const std::array<float, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

SidesSeen::SidesSeen(const JobBody& body, const optics::Surface& surface, const Progress& progress)
    : count_(surface.cells.size()) {
    static_assert(directions <= 255);
    if (body.is_picture) {
        for (auto& of_cell : count_) of_cell[static_cast<std::size_t>(Side::top)] = directions;
        return;
    }
    const MeshBoundary mesh = boundary_of(body);
    const Eigen::Vector3d& pitch_mm = body.grid.pitch_mm;
    double above_mm = 0;
    for (std::size_t a = 0; a < 3; ++a)
        above_mm = std::max(above_mm, 0.5 * surface.cell_voxels[a] * pitch_mm[static_cast<Eigen::Index>(a)]);
    parallel_for(
        0, count_.size(), 1024,
        [&](std::size_t i) {
            const Eigen::Vector3d normal = vector_from(surface.cells[i].normal),
                                  from = vector_from(surface.cells[i].centre_mm) + above_mm * normal;
            const double turned = RandomStream(0, i).uniform();
            for (std::size_t k = 0; k < directions; ++k) {
                const Eigen::Vector3d out = look_out(normal, k, turned);
                if (!mesh.corner_met({from[0], from[1], from[2]}, {out[0], out[1], out[2]}))
                    ++count_[i][static_cast<std::size_t>(side_of(out))];
            }
        },
        &progress);
}

double SidesSeen::from(Side side, std::size_t cell) const {
    return double(count_[cell][static_cast<std::size_t>(side)]) / double(directions);
}

double SidesSeen::weight(std::size_t cell) const {
    double sum = 0;
    for (std::size_t s = 0; s < all_sides; ++s) {
        const auto side = static_cast<Side>(s);
        sum += share_of(side) * from(side, cell);
    }
    return sum;
}

Side SidesSeen::main_side(std::span<const std::uint32_t> cells) const {
    std::array<double, all_sides> sum{};
    for (const std::uint32_t cell : cells)
        for (std::size_t s = 0; s < all_sides; ++s)
            sum[s] += share_of(static_cast<Side>(s)) * from(static_cast<Side>(s), cell);
    return static_cast<Side>(std::ranges::max_element(sum) - sum.begin());
}

std::vector<double> seen_areas(const optics::Surface& surface, const SidesSeen& sides) {
    std::vector<double> areas(surface.cells.size());
    for (std::size_t i = 0; i < areas.size(); ++i) areas[i] = double(surface.cells[i].area_mm2) * sides.weight(i);
    return areas;
}

const char* from_words(Side side) {
    switch (side) {
        case Side::front:
            return "from the front";
        case Side::back:
            return "from the back";
        case Side::left:
            return "from the left";
        case Side::right:
            return "from the right";
        case Side::top:
            return "from above";
        case Side::bottom:
            break;
    }
    return "from below";
}

}  // namespace voxtone::slicer
