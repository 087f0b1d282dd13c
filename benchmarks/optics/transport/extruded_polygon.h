// SPDX-License-Identifier: GPL-3.0-or-later
//
// A polygon, which need not be convex, pulled along y: a body with flat sides and a surface that is known exactly.
#pragma once

#include <array>
#include <vector>

#include "optics/scene/boundary.h"

namespace voxtone::accuracy {

class ExtrudedPolygon final : public optics::BodyBoundary {
public:
    /// Corners (x, z) in mm, counter-clockwise with x to the right and z up; no corner twice. The body reaches from y =
    /// `from` to `to`.
    ExtrudedPolygon(std::vector<std::array<double, 2>> corners, double from, double to);

    [[nodiscard]] bool inside(const optics::Point& p) const;

    [[nodiscard]] bool leaves(const optics::Point& from, const optics::Point& direction, double reach, double& distance,
                              optics::BoundaryNormals& normals) const override;
    [[nodiscard]] optics::Point nearest(const optics::Point& p, optics::BoundaryNormals& normals) const override;
    [[nodiscard]] bool comes_within(const optics::Point& p, double radius_mm) const override;

private:
    struct Edge {
        std::array<double, 2> start, along, outward;  // unit vectors
        double length;
    };
    [[nodiscard]] bool inside_polygon(double x, double z) const;

    std::vector<std::array<double, 2>> corners_;
    std::vector<Edge> edges_;
    double from_, to_;
};

}  // namespace voxtone::accuracy
