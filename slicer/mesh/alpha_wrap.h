// SPDX-License-Identifier: GPL-3.0-or-later
//
// A closed surface shrunk onto any heap of triangles, for meshes that no stitching can close (CGAL's alpha wrapping:
// C. Portaneri et al., "Alpha wrapping with an offset", ACM Trans. Graph. 41 (2022)).
// The result encloses the input everywhere, is a 2-manifold, lies `offset` outside of the input where that is convex,
// and does not enter gaps narrower than `alpha`. Cost: about area / alpha^2 facets.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/step_share.h"

namespace voxtone::slicer {

struct Wrap {
    std::vector<Eigen::Vector3d> positions;
    std::vector<Triangle> triangles;
};

/// alpha, offset > 0, in the unit of the positions. Nothing when the wrap would take more than `max_points` points.
/// `bar` advances by a task a point.
[[nodiscard]] std::optional<Wrap> alpha_wrap(std::span<const Eigen::Vector3d> positions,
                                             std::span<const Triangle> triangles, double alpha, double offset,
                                             std::size_t max_points, const Progress* progress = nullptr,
                                             StepShare* bar = nullptr);

}  // namespace voxtone::slicer
