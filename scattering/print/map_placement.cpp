// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/map_placement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/error.h"
#include "slicer/mesh/box.h"

namespace voxtone::scattering {

namespace {

std::array<Eigen::Vector2f, 3> frame(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return {a.cast<float>(), (b - a).cast<float>(), (c - a).cast<float>()};
}

}  // namespace

MapPlacement MapPlacement::by_texture(const io::TexturedMesh& mesh, double map_width_mm, double map_height_mm) {
    const auto has_extent = [](const std::array<Eigen::Vector2f, 3>& uv) { return uv[0] != uv[1] || uv[0] != uv[2]; };
    if (std::none_of(mesh.corner_uv.begin(), mesh.corner_uv.end(), has_extent))
        throw InputError(
            "the model has no texture coordinates, so nothing says where on it the map of profiles lies; try "
            "--profile-placement box");
    const Eigen::Vector2d size(map_width_mm, map_height_mm);
    MapPlacement placement;
    for (const auto& uv : mesh.corner_uv) {
        const auto corner = [&](std::size_t k) { return Eigen::Vector2d(uv[k].cast<double>().cwiseProduct(size)); };
        placement.frame_.push_back(frame(corner(0), corner(1), corner(2)));
    }
    return placement;
}

MapPlacement MapPlacement::by_box(const io::TexturedMesh& mesh) {
    const Eigen::AlignedBox3d box = slicer::bounding_box(mesh.positions, mesh.triangles);
    const Eigen::Vector3d &low = box.min(), &high = box.max();
    MapPlacement placement;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3d &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        const Eigen::Vector3d normal = (q - p).cross(r - p);
        int axis = 2;
        for (const int other : {1, 0})
            if (std::abs(normal[other]) > std::abs(normal[axis])) axis = other;
        const bool outward = normal[axis] >= 0;
        // Seen from outside: up is +z, on top and below +y; right is what makes the view upright.
        const int right = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
        const bool mirrored = outward == (axis == 1);
        const auto flat = [&](const Eigen::Vector3d& x) {
            return Eigen::Vector2d(mirrored ? high[right] - x[right] : x[right] - low[right], x[up] - low[up]);
        };
        placement.frame_.push_back(frame(flat(p), flat(q), flat(r)));
    }
    return placement;
}

}  // namespace voxtone::scattering
