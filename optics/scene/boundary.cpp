// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/boundary.h"

#include <algorithm>
#include <cmath>

#include "optics/scene/fresnel.h"

namespace voxtone::optics {
namespace {

Point reflected(const Point& d, const Point& n) {
    const double twice = 2 * dot(d, n);
    return {d[0] - twice * n[0], d[1] - twice * n[1], d[2] - twice * n[2]};
}

}  // namespace

double turn_at_boundary(const BoundaryNormals& normals, double eta, Point& direction) {
    double cosine = dot(direction, normals.shading);
    Point back = reflected(direction, normals.shading);
    if (cosine <= 0 || dot(back, normals.geometric) >= 0) {
        cosine = std::max(0.0, dot(direction, normals.geometric));
        back = reflected(direction, normals.geometric);
    }
    direction = back;
    const double mu2 = 1 - eta * eta * (1 - cosine * cosine);
    return mu2 <= 0 ? 1.0 : fresnel_reflectance(std::min(1.0, std::sqrt(mu2)), eta);
}

namespace {

/// A direction on the other side of a face with normal n along the ray, `ratio` = index before / index behind; all of
/// it along the face where none goes through.
Point refracted(const Point& d, const Point& n, double ratio) {
    const double cosine = std::max(0.0, dot(d, n)), behind = std::max(0.0, 1 - ratio * ratio * (1 - cosine * cosine)),
                 along = std::sqrt(behind) - ratio * cosine;
    Point out{};
    double length = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        out[a] = ratio * d[a] + along * n[a];
        length += out[a] * out[a];
    }
    for (double& x : out) x /= std::sqrt(length);
    return out;
}

Point negative(const Point& p) { return {-p[0], -p[1], -p[2]}; }

}  // namespace

Point leaving_direction(const BoundaryNormals& normals, double eta, const Point& direction) {
    if (dot(direction, normals.shading) > 0) {
        const Point out = refracted(direction, normals.shading, eta);
        if (dot(out, normals.geometric) > 0) return out;
    }
    return refracted(direction, normals.geometric, eta);
}

MetFromOutside meet_from_outside(const BoundaryNormals& normals, double eta, const Point& direction) {
    const auto about = [&](const Point& n) {
        return MetFromOutside{fresnel_reflectance(std::min(1.0, -dot(direction, n)), eta), reflected(direction, n),
                              refracted(direction, negative(n), 1 / eta)};
    };
    if (dot(direction, normals.shading) < 0) {
        const MetFromOutside met = about(normals.shading);
        if (dot(met.reflected, normals.geometric) > 0 && dot(met.refracted, normals.geometric) < 0) return met;
    }
    return about(normals.geometric);
}

Point entering_direction(const BoundaryNormals& normals, const Point& inward_u_v) {
    const auto about = [&](const Point& n) {
        // Two directions across n (Duff et al. 2017, "Building an orthonormal basis, revisited").
        const double s = std::copysign(1.0, n[2]), k = -1 / (s + n[2]), m = n[0] * n[1] * k;
        const Point e{1 + s * n[0] * n[0] * k, s * m, -s * n[0]}, f{m, s + n[1] * n[1] * k, -n[1]};
        Point d{};
        for (std::size_t a = 0; a < 3; ++a) d[a] = -inward_u_v[0] * n[a] + inward_u_v[1] * e[a] + inward_u_v[2] * f[a];
        return d;
    };
    const Point d = about(normals.shading);
    return dot(d, normals.geometric) < 0 ? d : about(normals.geometric);
}

float safe_component(double x) { return static_cast<float>(std::abs(x) < 1e-18 ? std::copysign(1e-18, x) : x); }

double FlatSides::height(const Point& p, const Plane*& highest) const {
    double most = -1e300;
    for (const Plane& plane : planes_) {
        const double h = dot(plane.normal, p) - plane.offset;
        if (h > most) {
            most = h;
            highest = &plane;
        }
    }
    return most;
}

bool FlatSides::leaves(const Point& from, const Point& direction, double reach, double& distance,
                       BoundaryNormals& normals) const {
    double first = reach;
    const Plane* left = nullptr;
    for (const Plane& plane : planes_) {
        const double speed = dot(plane.normal, direction);
        if (speed <= 0) continue;
        const double t = std::max(0.0, (plane.offset - dot(plane.normal, from)) / speed);
        if (t <= first) {
            first = t;
            left = &plane;
        }
    }
    if (!left) return false;
    distance = first;
    normals = {left->normal, left->normal};
    return true;
}

bool FlatSides::meets(const Point& from, const Point& direction, double& distance, BoundaryNormals& normals) const {
    double in = off_the_start_mm, out = 1e300;
    const Plane* entered = nullptr;
    for (const Plane& plane : planes_) {
        const double speed = dot(plane.normal, direction), height = dot(plane.normal, from) - plane.offset;
        if (speed == 0) {
            if (height > 0) return false;
            continue;
        }
        const double t = -height / speed;
        if (speed > 0) {
            out = std::min(out, t);
        } else if (t > in) {
            in = t;
            entered = &plane;
        }
    }
    if (!entered || in >= out) return false;
    distance = in;
    normals = {entered->normal, entered->normal};
    return true;
}

Point FlatSides::nearest(const Point& p, BoundaryNormals& normals) const {
    const Plane* plane = nullptr;
    const double h = height(p, plane);
    normals = {plane->normal, plane->normal};
    Point on = p;
    for (std::size_t a = 0; a < 3; ++a) on[a] -= h * plane->normal[a];
    return on;
}

bool FlatSides::comes_within(const Point& p, double radius_mm) const {
    const Plane* plane = nullptr;
    return std::abs(height(p, plane)) <= radius_mm;
}

bool Sphere::leaves(const Point& from, const Point& direction, double reach, double& distance,
                    BoundaryNormals& normals) const {
    Point r{};
    for (std::size_t a = 0; a < 3; ++a) r[a] = from[a] - centre_[a];
    const double along = dot(r, direction), outside = dot(r, r) - radius_ * radius_;
    const double root = std::sqrt(std::max(0.0, along * along - outside));
    const double t = std::max(0.0, root - along);
    if (t > reach) return false;
    distance = t;
    for (std::size_t a = 0; a < 3; ++a) r[a] += t * direction[a];
    const double length = std::sqrt(dot(r, r));
    for (double& x : r) x /= length;
    normals = {r, r};
    return true;
}

bool Sphere::meets(const Point& from, const Point& direction, double& distance, BoundaryNormals& normals) const {
    Point r{};
    for (std::size_t a = 0; a < 3; ++a) r[a] = from[a] - centre_[a];
    const double way = dot(r, direction), square = way * way - dot(r, r) + radius_ * radius_;
    if (square <= 0) return false;
    const double t = -way - std::sqrt(square);
    if (t <= off_the_start_mm) return false;
    distance = t;
    for (std::size_t a = 0; a < 3; ++a) r[a] = (r[a] + t * direction[a]) / radius_;
    normals = {r, r};
    return true;
}

Point Sphere::nearest(const Point& p, BoundaryNormals& normals) const {
    Point r{};
    for (std::size_t a = 0; a < 3; ++a) r[a] = p[a] - centre_[a];
    const double length = std::sqrt(dot(r, r));
    Point on = centre_;
    for (std::size_t a = 0; a < 3; ++a) {
        r[a] /= length;
        on[a] += radius_ * r[a];
    }
    normals = {r, r};
    return on;
}

bool Sphere::comes_within(const Point& p, double radius_mm) const {
    Point r{};
    for (std::size_t a = 0; a < 3; ++a) r[a] = p[a] - centre_[a];
    return std::abs(std::sqrt(dot(r, r)) - radius_) <= radius_mm;
}

}  // namespace voxtone::optics
