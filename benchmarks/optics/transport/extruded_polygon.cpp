// SPDX-License-Identifier: GPL-3.0-or-later
#include "extruded_polygon.h"

#include <algorithm>
#include <cmath>

namespace voxtone::accuracy {

using optics::BoundaryNormals;
using optics::Point;

namespace {

// How far outside a start may lie, and how far beside its end an edge still catches a ray: far below a voxel.
constexpr double outside_mm = 1e-3, beside_mm = 1e-7;

BoundaryNormals flat(double x, double y, double z) { return {{x, y, z}, {x, y, z}}; }

}  // namespace

ExtrudedPolygon::ExtrudedPolygon(std::vector<std::array<double, 2>> corners, double from, double to)
    : corners_(std::move(corners)), from_(from), to_(to) {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const auto &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
        const double length = std::hypot(b[0] - a[0], b[1] - a[1]), x = (b[0] - a[0]) / length,
                     z = (b[1] - a[1]) / length;
        edges_.push_back({a, {x, z}, {z, -x}, length});
    }
}

bool ExtrudedPolygon::inside_polygon(double x, double z) const {
    bool in = false;
    for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
        const auto &a = corners_[i], &b = corners_[j];
        if ((a[1] > z) != (b[1] > z) && x < (b[0] - a[0]) * (z - a[1]) / (b[1] - a[1]) + a[0]) in = !in;
    }
    return in;
}

bool ExtrudedPolygon::inside(const Point& p) const { return p[1] > from_ && p[1] < to_ && inside_polygon(p[0], p[2]); }

bool ExtrudedPolygon::leaves(const Point& from, const Point& direction, double reach, double& distance,
                             BoundaryNormals& normals) const {
    double best = reach;
    bool found = false;
    const auto meet = [&](double t, const BoundaryNormals& n) {
        if (t > best) return;
        best = std::max(0.0, t);
        normals = n;
        found = true;
    };
    for (const Edge& e : edges_) {
        const double towards = e.outward[0] * direction[0] + e.outward[1] * direction[2];
        if (towards <= 0) continue;
        const double x = from[0] - e.start[0], z = from[2] - e.start[1], depth = -(e.outward[0] * x + e.outward[1] * z);
        if (depth < -outside_mm) continue;
        const double t = depth / towards;
        if (t > best) continue;
        const double at = e.along[0] * (x + t * direction[0]) + e.along[1] * (z + t * direction[2]);
        if (at >= -beside_mm && at <= e.length + beside_mm) meet(t, flat(e.outward[0], 0, e.outward[1]));
    }
    if (direction[1] > 0) meet((to_ - from[1]) / direction[1], flat(0, 1, 0));
    if (direction[1] < 0) meet((from_ - from[1]) / direction[1], flat(0, -1, 0));
    if (found) distance = best;
    return found;
}

Point ExtrudedPolygon::nearest(const Point& p, BoundaryNormals& normals) const {
    Point best{};
    double least = 1e300;
    const auto offer = [&](const Point& q, const BoundaryNormals& n) {
        const double d = std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
        if (d >= least) return;
        least = d;
        best = q;
        normals = n;
    };
    for (const Edge& e : edges_) {
        const double at =
            std::clamp(e.along[0] * (p[0] - e.start[0]) + e.along[1] * (p[2] - e.start[1]), 0.0, e.length);
        offer({e.start[0] + at * e.along[0], std::clamp(p[1], from_, to_), e.start[1] + at * e.along[1]},
              flat(e.outward[0], 0, e.outward[1]));
    }
    if (inside_polygon(p[0], p[2])) {
        offer({p[0], from_, p[2]}, flat(0, -1, 0));
        offer({p[0], to_, p[2]}, flat(0, 1, 0));
    }
    return best;
}

bool ExtrudedPolygon::comes_within(const Point& p, double radius_mm) const {
    if (p[1] - from_ <= radius_mm || to_ - p[1] <= radius_mm) return true;
    for (const Edge& e : edges_) {
        const double x = p[0] - e.start[0], z = p[2] - e.start[1];
        const double at = std::clamp(e.along[0] * x + e.along[1] * z, 0.0, e.length);
        const double dx = x - at * e.along[0], dz = z - at * e.along[1];
        if (dx * dx + dz * dz <= radius_mm * radius_mm) return true;
    }
    return false;
}

}  // namespace voxtone::accuracy
