// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/area_points.h"

#include <cmath>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/surface/area_samples.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

std::vector<AreaPoint> area_points(const VisibleSurface& surface, const io::TexturedMesh& mesh) {
    constexpr std::uint64_t pieces = 50'000, seed = 1;
    constexpr float white_from = 0.9f;
    std::vector<AreaPoint> found;
    if (surface.triangles.empty()) return found;
    const AreaSamples area(surface);
    const SurfaceColour colour(mesh, std::sqrt(area.area_mm2() / double(pieces)));
    found.resize(pieces);
    parallel_for(0, pieces, 1024, [&](std::size_t i) {
        const AreaSamples::Sample s = area.at(seed, i);
        const auto& t = surface.triangles[s.triangle];
        const Eigen::Vector3d &a = surface.positions_mm[t[0]], &b = surface.positions_mm[t[1]],
                              &c = surface.positions_mm[t[2]];
        const auto& place = surface.source_uv[s.triangle];
        const Eigen::Vector2f uv = float(1 - s.u - s.v) * place[0] + float(s.u) * place[1] + float(s.v) * place[2];
        const Eigen::Vector3f rgb = colour.at(surface.source_triangle[s.triangle], uv.x(), uv.y());
        found[i] = {a + s.u * (b - a) + s.v * (c - a), (b - a).cross(c - a).normalized(), rgb.minCoeff() >= white_from};
    });
    return found;
}

}  // namespace voxtone::slicer
