// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/laminate_fit.h"

#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/mesh/triangle_tree.h"
#include "slicer/surface/area_samples.h"

namespace voxtone::scattering {

LaminateFit laminate_fit(const slicer::SurfaceIndex& coloured, const slicer::VoxelGrid& grid,
                         std::optional<double> slab_mm, const WrappedLayers& wrapped, const Progress& progress) {
    constexpr std::size_t samples = 20000;
    const slicer::VisibleSurface& surface = *coloured;
    if (!(slicer::coloured_area_mm2(surface) > 0)) return {};
    const slicer::AreaSamples points(surface);
    const slicer::TriangleTree& tree = coloured.tree();
    const double slack = grid.pitch_mm.maxCoeff();
    std::vector<double> missing(samples, 0);
    parallel_for(
        0, samples, 64,
        [&](std::size_t i) {
            const auto [t, u, v] = points.at(2, i);
            const auto& corner = surface.source_uv[t];
            const Eigen::Vector2f at = float(1 - u - v) * corner[0] + float(u) * corner[1] + float(v) * corner[2];
            const Eigen::Vector2f place = wrapped.map_point(t, at.x(), at.y());
            const double depth = wrapped.fields().depth_mm(place.x(), place.y());
            if (!(depth > slack)) return;
            // A picture's slab has its depth counted from the top only.
            const auto [p0, p1, p2] = tree.corners(t);
            const Eigen::Vector3d p = (1 - u - v) * p0 + u * p1 + v * p2;
            const Eigen::Vector3d normal = (p1 - p0).cross(p2 - p0).normalized();
            const auto fits = [&](double h) {
                return slab_mm ? h <= *slab_mm + slack : tree.nearest(p - h * normal, t).distance >= h - slack;
            };
            if (fits(depth)) return;
            double low = 0, high = depth;
            for (int step = 0; step < 10; ++step) (fits(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
            missing[i] = 1 - low / depth;
        },
        &progress);
    LaminateFit fit;
    for (const double m : missing)
        if (m > 0) fit.thin_share += 1, fit.missing_mean += m;
    if (fit.thin_share > 0) fit.missing_mean /= fit.thin_share;
    fit.thin_share /= double(samples);
    return fit;
}

}  // namespace voxtone::scattering
