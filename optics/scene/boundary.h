// SPDX-License-Identifier: GPL-3.0-or-later
//
// The true surface of a body, where light paths are to see more of it than the staircase of its voxels.
//
// Coordinates are mm from the corner of the volume. Light is refracted and reflected about the shading normal, which
// may be smoother than the surface is; where that would send light through the surface the geometric normal takes its
// place, so that no light is lost or made. Which resin is at a point the voxels say; between them and the surface lies
// the resin of the nearest solid voxel.
#pragma once

#include <span>
#include <vector>

#include "optics/scene/point.h"

namespace voxtone::optics {

/// Unit vectors, outward.
struct BoundaryNormals {
    Point shading{}, geometric{};
};

/// Paths that stay inside are set off from the surface by this much, so that rounding does not put them outside.
inline constexpr double inside_boundary_mm = 1e-4;
/// What a ray in the air starts from is not met again nearer than this, rounding included.
inline constexpr double off_the_start_mm = 1e-3;

/// A ray in the resin meets the surface: the share that is reflected, and `direction` turned as the reflected ray.
/// About the shading normal, or the geometric one where the shading normal would lose the ray.
[[nodiscard]] double turn_at_boundary(const BoundaryNormals& normals, double eta, Point& direction);

/// The direction in air of a ray in the resin that the surface let out, by Snell's law about the shading normal, or the
/// geometric one where that would send it back in. `direction` as it came; unit vectors; eta >= 1 of the resin.
[[nodiscard]] Point leaving_direction(const BoundaryNormals& normals, double eta, const Point& direction);

/// A ray in air meets the surface: the share that is reflected (Fresnel, unpolarised), and where either part goes,
/// about the shading normal, or the geometric one where the parts would change sides.
struct MetFromOutside {
    double reflectance = 0;
    Point reflected{}, refracted{};
};
[[nodiscard]] MetFromOutside meet_from_outside(const BoundaryNormals& normals, double eta, const Point& direction);

/// The direction in the resin of a ray that the surface let in, given its components along the inward normal and
/// across.
[[nodiscard]] Point entering_direction(const BoundaryNormals& normals, const Point& inward_u_v);

/// A direction's component that is never 0.
[[nodiscard]] float safe_component(double x);

class BodyBoundary {
public:
    virtual ~BodyBoundary() = default;

    /// Where a ray that starts inside first leaves the body, no farther than `reach` mm; false where it stays inside.
    /// `direction` has unit length. A start on the surface or a rounding error outside of it counts as inside.
    [[nodiscard]] virtual bool leaves(const Point& from, const Point& direction, double reach, double& distance,
                                      BoundaryNormals& normals) const = 0;

    /// Where a ray in the air first meets the body. A start on the surface does not count.
    [[nodiscard]] virtual bool meets(const Point& /*from*/, const Point& /*direction*/, double& /*distance*/,
                                     BoundaryNormals& /*normals*/) const {
        return false;
    }

    /// The point of the surface that is nearest to p, for p close to the surface.
    [[nodiscard]] virtual Point nearest(const Point& p, BoundaryNormals& normals) const = 0;

    /// Whether the surface may come as close as this to p. A wrong yes costs time, a wrong no is not allowed.
    [[nodiscard]] virtual bool comes_within(const Point& p, double radius_mm) const = 0;
};

/// What lies below a set of planes: a half-space, a slab, a convex body with flat sides.
class FlatSides : public BodyBoundary {
public:
    /// Inside is normal * p <= offset. Normals have unit length.
    struct Plane {
        Point normal{};
        double offset = 0;
    };
    explicit FlatSides(std::vector<Plane> planes) : planes_(std::move(planes)) {}

    [[nodiscard]] bool leaves(const Point& from, const Point& direction, double reach, double& distance,
                              BoundaryNormals& normals) const override;
    [[nodiscard]] bool meets(const Point& from, const Point& direction, double& distance,
                             BoundaryNormals& normals) const override;
    [[nodiscard]] Point nearest(const Point& p, BoundaryNormals& normals) const override;
    [[nodiscard]] bool comes_within(const Point& p, double radius_mm) const override;

private:
    [[nodiscard]] double height(const Point& p, const Plane*& highest) const;
    std::vector<Plane> planes_;
};

class Sphere : public BodyBoundary {
public:
    Sphere(const Point& centre, double radius_mm) : centre_(centre), radius_(radius_mm) {}

    [[nodiscard]] bool leaves(const Point& from, const Point& direction, double reach, double& distance,
                              BoundaryNormals& normals) const override;
    [[nodiscard]] bool meets(const Point& from, const Point& direction, double& distance,
                             BoundaryNormals& normals) const override;
    [[nodiscard]] Point nearest(const Point& p, BoundaryNormals& normals) const override;
    [[nodiscard]] bool comes_within(const Point& p, double radius_mm) const override;

private:
    Point centre_;
    double radius_;
};

}  // namespace voxtone::optics
