// SPDX-License-Identifier: GPL-3.0-or-later
//
// The step edge seen through a slab, path by path from the camera to the light, bounces off the sheet and all: a
// renderer for what a bench would measure. It shares the scene and the physics of a boundary with edge_paths.h, but
// neither its kernels nor the integral equation, so that each can be held against the other.
//
// A path keeps where it met the sheet's base. As seen from a place x0 of the camera these places move along, so one
// path gives its light to every x0: alpha^n times the reflectance on that side for each meeting, a function of x0 with
// a step where a meeting crosses the edge. Russian roulette where little weight is left; unbiased.
#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "optics/edge/edge_response.h"

namespace voxtone::optics {

struct EdgeScene {
    EdgeAssembly assembly;
    double slab_mm = 0.5, sigma_t = 5, albedo = 0.9, g = 0.4;
    EdgeSheet sheet;
    std::uint32_t paths = 1u << 18;
    std::uint64_t seed = 1;
};

/// F at the middles of cells of `step_mm` from -reach_mm to reach_mm, relative to a perfect diffuser in the same light.
/// The same bits for any number of threads.
[[nodiscard]] std::vector<double> render_edge(const EdgeScene& scene, double reach_mm, double step_mm,
                                              const Progress* progress = nullptr);

}  // namespace voxtone::optics
