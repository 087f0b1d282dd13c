// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/skin_source.h"

#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "base/parallel.h"

namespace voxtone::slicer {

SurfacePlaces::SurfacePlaces(const VisibleSurface& surface, const Eigen::Vector3d& corner_mm)
    : frame_(surface.triangles.size()) {
    parallel_for(0, frame_.size(), 1024, [&](std::size_t t) {
        Eigen::Matrix3d corner;  // columns
        Eigen::Matrix2d uv;
        for (int k = 0; k < 3; ++k)
            corner.col(k) = surface.positions_mm[surface.triangles[t][static_cast<std::size_t>(k)]] - corner_mm;
        const auto& place = surface.source_uv[t];
        for (int k = 0; k < 2; ++k) uv.col(k) = (place[static_cast<std::size_t>(k + 1)] - place[0]).cast<double>();
        auto& [origin, along_u, along_v] = frame_[t];
        // Patches over holes take all their colour from one place: they are taken to lie at their middle.
        if (std::abs(uv.determinant()) < 1e-12) {
            origin = corner.rowwise().mean().cast<float>();
            along_u = along_v = Eigen::Vector3f::Zero();
            return;
        }
        Eigen::Matrix<double, 3, 2> edges;
        for (int k = 0; k < 2; ++k) edges.col(k) = corner.col(k + 1) - corner.col(0);
        const Eigen::Matrix<double, 3, 2> by_uv = edges * uv.inverse();
        origin = (corner.col(0) - by_uv * place[0].cast<double>()).cast<float>();
        along_u = by_uv.col(0).cast<float>();
        along_v = by_uv.col(1).cast<float>();
    });
}

SkinSource::SkinSource(const SkinMap& map, const halftone::SkinMixtures& mixtures, int core)
    : SkinSource(map, halftone::cumulative_mixtures(mixtures), mixtures.resins(), core) {}

SkinSource::SkinSource(const SkinMap& map, std::vector<halftone::CumulativeMixture> mixtures, std::size_t resins,
                       int core)
    : map_(map), mixture_(std::move(mixtures)) {
    halftone::SkinMixtures pure(1, 1, resins);
    pure.cell(0)[static_cast<std::size_t>(core)] = 1;
    core_ = halftone::cumulative_mixtures(pure)[0];
}

}  // namespace voxtone::slicer
