// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/white_surface.h"

#include <cmath>

#include "slicer/surface/area_samples.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

bool is_all_white(const io::TexturedMesh& mesh, const VisibleSurface& surface) {
    if (surface.triangles.empty()) return true;
    constexpr std::uint64_t spots = 20'000, samples = 4 * spots;
    const AreaSamples area(surface);
    const SurfaceColour colour(mesh, std::sqrt(area.area_mm2() / double(spots)));
    const auto is_white = [&](std::uint32_t triangle, float u, float v) {
        const auto& place = surface.source_uv[triangle];
        const Eigen::Vector2f uv = (1 - u - v) * place[0] + u * place[1] + v * place[2];
        return colour.at(surface.source_triangle[triangle], uv.x(), uv.y()).minCoeff() > 0.995f;
    };
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
        if (!is_white(t, 1 / 3.0f, 1 / 3.0f)) return false;
    for (std::uint64_t i = 0; i < samples; ++i) {
        const AreaSamples::Sample s = area.at(1, i);
        if (!is_white(s.triangle, float(s.u), float(s.v))) return false;
    }
    return true;
}

}  // namespace voxtone::slicer
