// SPDX-License-Identifier: GPL-3.0-or-later
//
// A Gaussian of any width over a surface given as points with areas: flat, curved, thin. What gaussian_gather.h says of
// who is seen together holds here.
//
// Gaussians wider than a few points go by way of a lattice: the points in a box that look along the same axis become
// one, these are smoothed, and a narrow Gaussian brings the result back to the points; spreads add up in squares, the
// boxes' own blur with them. Error of the transfer function: below 0.01. Work per point and call does not grow with the
// spread.
//
// Memory: 16 bytes per point besides the points (32 where there is no lattice). Results are the same bits for any
// number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "optics/scene/appearance_model.h"
#include "optics/scene/gaussian_gather.h"

namespace voxtone::optics {

/// One per cell.
[[nodiscard]] std::vector<SurfacePoint> surface_points(const Surface& surface);
/// Edge of a square that is as large as points' areas are where most of the surface is, mm.
[[nodiscard]] double typical_edge_mm(std::span<const SurfacePoint> points);

class SurfaceSmoothing {
public:
    /// Smoothing of values that were smoothed by `done_mm` before, so that together they make `spread_mm`. `point_mm`:
    /// typical distance of points. The points must outlive this.
    SurfaceSmoothing(std::span<const SurfacePoint> points, double spread_mm, double done_mm, double point_mm);
    // Refers to parts of itself.
    SurfaceSmoothing(const SurfaceSmoothing&) = delete;
    SurfaceSmoothing& operator=(const SurfaceSmoothing&) = delete;
    void apply(std::span<const float> in, std::span<float> out, std::size_t channels) const;

private:
    std::span<const SurfacePoint> points_;
    std::vector<std::uint32_t> cluster_of_;  ///< empty: no lattice
    std::vector<std::uint32_t> cluster_order_, cluster_begin_;
    std::vector<SurfacePoint> clusters_;
    std::unique_ptr<GaussianGather> between_, back_;
};

}  // namespace voxtone::optics
