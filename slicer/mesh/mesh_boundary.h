// SPDX-License-Identifier: GPL-3.0-or-later
//
// A triangle mesh as the boundary of a body for light paths: rays by Embree, smooth shading normals.
//
// The shading normal at a corner is the mean of the normals of the triangles around it, weighted by their angles there
// (G. Thuermer, C. Wuethrich, "Computing vertex normals from polygonal facets", 1998), of those triangles alone that
// differ by less than the crease angle from the corner's own: edges of a box stay sharp. Within a triangle it is
// interpolated.
//
// The mesh must be closed and oriented outward, without parts that lie inside the body: what visible_surface.h leaves
// of a SolidMesh. A ray counts as leaving only through a triangle that looks its way, so a start that rounding put
// outside goes back in. Coordinates below 1e3 mm: rays are single precision, 1e-4 mm at worst.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "optics/scene/boundary.h"

namespace voxtone::slicer {

class MeshBoundary : public optics::BodyBoundary {
public:
    /// `corner_mm`: where in the mesh's coordinates the corner of the volume lies. The mesh is copied.
    MeshBoundary(std::span<const Eigen::Vector3d> positions_mm, std::span<const std::array<std::uint32_t, 3>> triangles,
                 const Eigen::Vector3d& corner_mm, double crease_radians = 0.7);
    ~MeshBoundary() override;
    MeshBoundary(MeshBoundary&&) noexcept;
    MeshBoundary& operator=(MeshBoundary&&) noexcept;

    [[nodiscard]] bool leaves(const optics::Point& from, const optics::Point& direction, double reach, double& distance,
                              optics::BoundaryNormals& normals) const override;
    [[nodiscard]] bool meets(const optics::Point& from, const optics::Point& direction, double& distance,
                             optics::BoundaryNormals& normals) const override;
    /// What a ray in the air first meets: of the corners of that triangle the nearest one, as its place in
    /// `positions_mm`. Nothing where it meets none.
    [[nodiscard]] std::optional<std::uint32_t> corner_met(const optics::Point& from,
                                                          const optics::Point& direction) const;
    /// The triangle that a ray in the air first meets: its corners as places in `positions_mm`, and their weights.
    struct Met {
        std::array<std::uint32_t, 3> corners{};
        std::array<float, 3> weights{};
        double distance = 0;
        optics::BoundaryNormals normals;
    };
    [[nodiscard]] std::optional<Met> triangle_met(const optics::Point& from, const optics::Point& direction) const;
    [[nodiscard]] optics::Point nearest(const optics::Point& p, optics::BoundaryNormals& normals) const override;
    [[nodiscard]] bool comes_within(const optics::Point& p, double radius_mm) const override;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace voxtone::slicer
