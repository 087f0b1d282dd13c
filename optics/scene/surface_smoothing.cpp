// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/surface_smoothing.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/scene/point_bins.h"

namespace voxtone::optics {

std::vector<SurfacePoint> surface_points(const Surface& surface) {
    std::vector<SurfacePoint> points(surface.cells.size());
    parallel_for(0, points.size(), 4096, [&](std::size_t i) {
        const SurfaceCell& cell = surface.cells[i];
        points[i] = {cell.centre_mm, cell.normal, std::max(cell.area_mm2, 1e-9F)};
    });
    return points;
}

double typical_edge_mm(std::span<const SurfacePoint> points) {
    double area = 0, squares = 0;
    for (const SurfacePoint& p : points) {
        area += p.area;
        squares += static_cast<double>(p.area) * p.area;
    }
    return std::sqrt(squares / area);
}

SurfaceSmoothing::SurfaceSmoothing(std::span<const SurfacePoint> points, double spread_mm, double done_mm,
                                   double point_mm)
    : points_(points) {
    VOXTONE_EXPECT(spread_mm > 0 && point_mm > 0 && spread_mm > done_mm);
    const double rest = std::sqrt(spread_mm * spread_mm - done_mm * done_mm);
    // Narrow: a lattice fine enough that a Gaussian of its own brings the values back, and no smoothing between.
    const bool narrow = rest < 5 * point_mm;
    const double pitch = narrow ? rest / 1.4 : rest / 3;
    if (pitch < 1.5 * point_mm) {
        back_ = std::make_unique<GaussianGather>(points, rest, point_mm);
        return;
    }
    const auto edge = static_cast<float>(pitch);
    BinnedPoints boxes = sort_into_bins(points.size(), [&](std::size_t i) {
        const auto& normal = points[i].normal;
        std::size_t axis = 0;
        for (std::size_t a = 1; a < 3; ++a)
            if (std::abs(normal[a]) > std::abs(normal[axis])) axis = a;
        return bin_of(place_of(points[i].at, edge), static_cast<unsigned>(2 * axis) + (normal[axis] > 0 ? 1U : 0U));
    });
    cluster_of_.resize(points.size());
    clusters_.resize(boxes.bins.size());
    double spread2 = 0, all_area = 0;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
        std::array<double, 3> at{}, normal{};
        double area = 0, r2 = 0;
        for (std::uint32_t i = boxes.begin[k]; i < boxes.begin[k + 1]; ++i) {
            const SurfacePoint& p = points[boxes.order[i]];
            cluster_of_[boxes.order[i]] = static_cast<std::uint32_t>(k);
            for (std::size_t a = 0; a < 3; ++a) at[a] += p.area * p.at[a], normal[a] += p.area * p.normal[a];
            area += p.area;
        }
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        SurfacePoint& cluster = clusters_[k];
        for (std::size_t a = 0; a < 3; ++a) {
            cluster.at[a] = static_cast<float>(at[a] / area);
            cluster.normal[a] = static_cast<float>(normal[a] / length);  // of one axis and sign: never zero
        }
        cluster.area = static_cast<float>(area);
        for (std::uint32_t i = boxes.begin[k]; i < boxes.begin[k + 1]; ++i) {
            const SurfacePoint& p = points[boxes.order[i]];
            for (std::size_t a = 0; a < 3; ++a) {
                const double d = p.at[a] - cluster.at[a];
                r2 += p.area * d * d;
            }
        }
        spread2 += r2;
        all_area += area;
    }
    // A plane Gaussian exp(-r^2 / spread^2) has the mean square radius spread^2: the boxes' own blur counts.
    const double left2 = std::max(rest * rest - spread2 / all_area, 0.25 * rest * rest);
    double back = std::sqrt(left2);
    if (!narrow) {
        back = std::min(back, 1.3 * pitch);
        const double between = std::sqrt(std::max(left2 - back * back, 0.01 * left2));
        between_ = std::make_unique<GaussianGather>(clusters_, between, 0.5 * pitch);
    }
    back_ = std::make_unique<GaussianGather>(clusters_, points_, cluster_of_, back, 0.5 * pitch);
    cluster_order_ = std::move(boxes.order);
    cluster_begin_ = std::move(boxes.begin);
}

void SurfaceSmoothing::apply(std::span<const float> in, std::span<float> out, std::size_t channels) const {
    if (clusters_.empty()) {
        back_->apply(in, out, channels);
        return;
    }
    std::vector<float> mean(clusters_.size() * channels), smooth(clusters_.size() * channels);
    parallel_for(0, clusters_.size(), 256, [&](std::size_t k) {
        for (std::size_t c = 0; c < channels; ++c) {
            double sum = 0;
            for (std::uint32_t i = cluster_begin_[k]; i < cluster_begin_[k + 1]; ++i)
                sum += static_cast<double>(points_[cluster_order_[i]].area) * in[cluster_order_[i] * channels + c];
            mean[k * channels + c] = static_cast<float>(sum / clusters_[k].area);
        }
    });
    if (between_) between_->apply(mean, smooth, channels);
    back_->apply(between_ ? smooth : mean, out, channels);
}

}  // namespace voxtone::optics
