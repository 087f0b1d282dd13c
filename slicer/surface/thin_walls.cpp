// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/thin_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/mesh/disjoint_sets.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/surface/area_samples.h"

namespace voxtone::slicer {

namespace {

using Eigen::Vector3d;

constexpr double points_a_limit = 3;
constexpr std::uint64_t most_points = 200'000, seed = 1;
constexpr double looking_away = -0.866;   // the cosine of 150 degrees
constexpr double shortest_in_limits = 2;  // of what is told,
constexpr double shortest_of_body = 0.5;  // or of a small body: by the diagonal of its box
constexpr std::size_t fewest_points = 6;
constexpr double touching = 0.05;  // in limits: what lies so near behind a face is one with it

struct Met {
    double distance;
    double facing;  ///< cosine between the line and the face's normal
};

/// Where the line meets a triangle's plane within it (Moeller, Trumbore 1997).
std::optional<Met> meet(const Vector3d& from, const Vector3d& way, const std::array<Vector3d, 3>& corner) {
    const Vector3d e1 = corner[1] - corner[0], e2 = corner[2] - corner[0], p = way.cross(e2);
    const double det = e1.dot(p);
    if (det == 0) return std::nullopt;
    const Vector3d s = from - corner[0], q = s.cross(e1);
    const double u = s.dot(p) / det, v = way.dot(q) / det, distance = e2.dot(q) / det;
    if (u < 0 || v < 0 || u + v > 1 || distance <= 0) return std::nullopt;
    return Met{distance, e1.cross(e2).normalized().dot(way)};
}

/// The faces on the way, the nearest first.
std::vector<Met> faces_on(const SolidIndex& solid, const Vector3d& from, const Vector3d& way, double length) {
    const Vector3d to = from + length * way;
    std::vector<std::uint32_t> near;
    solid.tree().overlapping(from.cwiseMin(to), from.cwiseMax(to), near);
    std::vector<Met> met;
    for (const std::uint32_t t : near)
        if (const auto found = meet(from, way, solid.tree().corners(t)); found && found->distance < length)
            met.push_back(*found);
    std::ranges::sort(met, {}, &Met::distance);
    return met;
}

int winding_behind(int winding, const std::vector<Met>& met) {
    for (const Met& m : met) winding += m.facing > 0 ? -1 : 1;
    return winding;
}

/// Where the body ends on the way, `winding` deep in it at its begin; nothing: beyond the length. Where the next piece
/// begins at once it does not end.
std::optional<Met> end_of_body(const SolidIndex& solid, const Vector3d& from, const Vector3d& way, double length,
                               int winding, double slack) {
    const std::vector<Met> met = faces_on(solid, from, way, length + slack);
    for (std::size_t m = 0; m < met.size() && met[m].distance < length; ++m) {
        winding += met[m].facing > 0 ? -1 : 1;
        if (winding > 0) continue;
        const bool goes_on =
            m + 1 < met.size() && met[m + 1].facing < 0 && met[m + 1].distance < met[m].distance + slack;
        if (!goes_on) return met[m];
    }
    return std::nullopt;
}

/// How far inward the body ends, where that is nearer than the limit and the face there looks away.
std::optional<double> thickness_at(const SolidIndex& solid, const Vector3d& at, const Vector3d& outward, double limit) {
    const auto end = end_of_body(solid, at - 1e-4 * limit * outward, -outward, limit, 1, touching * limit);
    if (!end || -end->facing > looking_away) return std::nullopt;
    return end->distance;
}

struct ThinPoint {
    Vector3d at_mm = Vector3d::Zero(), outward = Vector3d::Zero();
    double thickness_mm = 0;  ///< 0: not thin
    std::uint32_t source = 0;
};

/// Whether another piece covers the point: seams of what is seen reach a little into what hides it.
bool is_covered(const SolidIndex& solid, const ThinPoint& point, double limit, double reach) {
    const Vector3d above = point.at_mm + 1e-4 * limit * point.outward;
    return winding_behind(0, faces_on(solid, above, point.outward, reach)) < 0;
}

/// Whether the wall stands out of a thick body by less than it is thick, as stripes, frames and letters do: no farther
/// than that along the wall the body is as thick as the limit asks for.
bool is_low_rib(const SolidIndex& solid, const ThinPoint& point, double limit) {
    constexpr int ways = 8;
    const double slack = touching * limit, half = point.thickness_mm / 2;
    const Vector3d &n = point.outward, below = point.at_mm - 1e-4 * limit * n;
    const Vector3d middle = point.at_mm - half * n;
    const int winding = winding_behind(1, faces_on(solid, below, -n, half - 1e-4 * limit));
    const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
    for (int w = 0; w < ways; ++w) {
        const double angle = 2 * M_PI * w / ways;
        const Vector3d way = std::cos(angle) * u + std::sin(angle) * v, there = middle + point.thickness_mm * way;
        const int deep = winding_behind(winding, faces_on(solid, middle, way, point.thickness_mm));
        if (deep <= 0) continue;
        double thick = 0;
        for (const Vector3d& side : {Vector3d(n), Vector3d(-n)}) {
            const auto end = end_of_body(solid, there, side, limit, deep, slack);
            thick += end ? end->distance : limit;
        }
        if (thick >= limit) return true;
    }
    return false;
}

/// Without the points of low ribs, and covered ones; of many points some stand for all.
std::vector<ThinPoint> without_ribs(const SolidIndex& solid, std::vector<ThinPoint> place, double limit, double reach) {
    constexpr std::size_t most = 300;
    if (place.size() > most) place.resize(most);  // they lie in random order
    std::vector<char> rib(place.size());
    parallel_for(0, place.size(), 16, [&](std::size_t i) {
        rib[i] = is_covered(solid, place[i], limit, reach) || is_low_rib(solid, place[i], limit);
    });
    std::vector<ThinPoint> walls;
    for (std::size_t i = 0; i < place.size(); ++i)
        if (!rib[i]) walls.push_back(place[i]);
    return walls;
}

std::vector<ThinPoint> thin_points(const VisibleSurface& surface, const SolidIndex& solid, const AreaSamples& samples,
                                   std::uint64_t count, double limit_mm) {
    std::vector<ThinPoint> points(count);
    parallel_for(0, count, 256, [&](std::size_t i) {
        const AreaSamples::Sample sample = samples.at(seed, i);
        const auto& [ia, ib, ic] = surface.triangles[sample.triangle];
        const Vector3d &a = surface.positions_mm[ia], &b = surface.positions_mm[ib], &c = surface.positions_mm[ic];
        const Vector3d normal = (b - a).cross(c - a);
        if (!(normal.norm() > 0)) return;
        const Vector3d at = a + sample.u * (b - a) + sample.v * (c - a);
        const auto thickness = thickness_at(solid, at, normal.normalized(), limit_mm);
        if (thickness) points[i] = {at, normal.normalized(), *thickness, surface.source_triangle[sample.triangle]};
    });
    std::erase_if(points, [](const ThinPoint& point) { return point.thickness_mm == 0; });
    return points;
}

/// Points in cells that touch are one place.
std::vector<std::vector<ThinPoint>> places_of(const std::vector<ThinPoint>& points, double cell_mm) {
    using Cell = std::array<int, 3>;
    std::map<Cell, std::uint32_t> cells;
    std::vector<std::uint32_t> cell_of(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3d at = (points[i].at_mm / cell_mm).array().floor();
        cell_of[i] =
            cells.try_emplace({int(at.x()), int(at.y()), int(at.z())}, std::uint32_t(cells.size())).first->second;
    }
    DisjointSets sets(cells.size());
    for (const auto& [cell, number] : cells)
        for (int n = 0; n < 27; ++n) {
            const auto beside = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
            if (beside != cells.end()) sets.unite(number, beside->second);
        }
    std::map<std::uint32_t, std::vector<ThinPoint>> by_root;
    for (std::size_t i = 0; i < points.size(); ++i) by_root[sets.root(cell_of[i])].push_back(points[i]);
    std::vector<std::vector<ThinPoint>> places;
    for (auto& [root, place] : by_root) places.push_back(std::move(place));
    return places;
}

ThinWall wall_of(std::vector<ThinPoint> points) {
    Eigen::AlignedBox3d box;
    for (const ThinPoint& point : points) box.extend(point.at_mm);
    const auto middle = points.begin() + std::ptrdiff_t(points.size() / 2);
    std::ranges::nth_element(points, middle, {}, &ThinPoint::thickness_mm);
    return {middle->thickness_mm, box.diagonal().norm(), box.center(), middle->source};
}

}  // namespace

std::vector<ThinWall> find_thin_walls(const VisibleSurface& surface, const SolidIndex& solid, double limit_mm,
                                      const Progress& progress) {
    if (surface.triangles.empty() || !(limit_mm > 0)) return {};
    const AreaSamples samples(surface);
    const double spacing = limit_mm / points_a_limit;
    const auto count = std::uint64_t(std::clamp(samples.area_mm2() / (spacing * spacing), 1.0, double(most_points)));
    const std::vector<ThinPoint> points = thin_points(surface, solid, samples, count, limit_mm);
    progress.check_cancelled();
    const double apart = std::sqrt(samples.area_mm2() / double(count));
    Eigen::AlignedBox3d box;
    for (const auto& triangle : surface.triangles)
        for (const std::uint32_t corner : triangle) box.extend(surface.positions_mm[corner]);
    const double shortest_mm = std::min(shortest_in_limits * limit_mm, shortest_of_body * box.diagonal().norm());
    const auto is_told = [&](const std::vector<ThinPoint>& place) {
        return place.size() >= fewest_points && wall_of(place).length_mm >= shortest_mm;
    };
    std::vector<ThinWall> walls;
    for (std::vector<ThinPoint>& place : places_of(points, std::max(limit_mm / 2, 2 * apart))) {
        progress.check_cancelled();
        if (!is_told(place)) continue;
        place = without_ribs(solid, std::move(place), limit_mm, box.diagonal().norm());
        if (is_told(place)) walls.push_back(wall_of(std::move(place)));
    }
    std::ranges::stable_sort(walls, std::greater(), &ThinWall::length_mm);
    return walls;
}

std::optional<double> larger_without_thin_walls(const VisibleSurface& surface, const SolidIndex& solid, double limit_mm,
                                                const Progress& progress) {
    // The larger body by the limit is this one by a lower limit.
    for (const double times : {1.25, 1.5, 2.0, 3.0, 4.0})
        if (find_thin_walls(surface, solid, limit_mm / times, progress).empty()) return times;
    return std::nullopt;
}

std::vector<Eigen::Vector3d> bare_joints(const SolidMesh& solid, double limit_mm) {
    const Shells shells = find_shells(solid.triangles);
    std::vector<Eigen::AlignedBox3d> box(shells.count);
    std::vector<std::vector<std::uint32_t>> at_corner(solid.positions_mm.size());
    for (std::size_t t = 0; t < solid.triangles.size(); ++t)
        for (const std::uint32_t corner : solid.triangles[t]) {
            box[shells.of_triangle[t]].extend(solid.positions_mm[corner]);
            if (std::ranges::find(at_corner[corner], shells.of_triangle[t]) == at_corner[corner].end())
                at_corner[corner].push_back(shells.of_triangle[t]);
        }
    std::map<std::pair<std::uint32_t, std::uint32_t>, Eigen::AlignedBox3d> shared;
    for (std::size_t corner = 0; corner < at_corner.size(); ++corner)
        for (std::size_t a = 1; a < at_corner[corner].size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
                shared[std::minmax(at_corner[corner][a], at_corner[corner][b])].extend(solid.positions_mm[corner]);
    constexpr std::uint32_t most_shells = 2000;  // all pairs are looked at
    if (shared.empty() || shells.count > most_shells) return {};
    const auto wide_axes = [&](const Eigen::AlignedBox3d& of) {
        return of.isEmpty() ? 0 : int((of.sizes().array() >= limit_mm).count());
    };
    DisjointSets held(shells.count);
    for (std::uint32_t a = 1; a < shells.count; ++a)
        for (std::uint32_t b = 0; b < a; ++b)
            if (wide_axes(box[a].intersection(box[b])) == 3) held.unite(a, b);
    for (const auto& [pair, where] : shared)
        if (wide_axes(where) >= 2) held.unite(pair.first, pair.second);
    std::vector<Eigen::Vector3d> joints;
    for (const auto& [pair, where] : shared)
        if (held.root(pair.first) != held.root(pair.second)) joints.push_back(where.center());
    return joints;
}

}  // namespace voxtone::slicer
