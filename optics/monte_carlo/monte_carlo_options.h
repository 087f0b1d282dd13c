// SPDX-License-Identifier: GPL-3.0-or-later
//
// What path tracing (monte_carlo.h) can be told, and what it tells besides the values.
#pragma once

#include <cstdint>

#include "optics/scene/boundary.h"

namespace voxtone::optics {

enum class PathTracer {
    packets,  ///< vector code: path_packets.h
    scalar,   ///< its definition, path by path, in double precision: scalar_paths.h
};

struct MonteCarloOptions {
    std::uint32_t paths = 256;          ///< per cell and channel, >= 2; where an error is wanted, the least number
    double error = 0;                   ///< wanted standard error of every cell and channel; 0: `paths` decides
    std::uint32_t max_paths = 1 << 20;  ///< no cell and channel gets more, whatever error it has
    std::uint64_t seed = 1;
    std::uint32_t first_path = 0;  ///< paths first_path .. first_path + paths - 1 of all there are: other paths are
                                   ///< independent of these
    /// The true surface of the body, which must outlive the model; nullptr: the faces of the voxels. Open sides only.
    const BodyBoundary* boundary = nullptr;
    /// With a boundary: light that leaves one part of the body and meets another goes on there (an ear, a fold, a cup).
    /// Else it counts as gone, and light comes in everywhere as if nothing were in its way: what a surface is by
    /// itself.
    bool follow_outside = false;
    PathTracer tracer = PathTracer::packets;  ///< `plain` knows no boundary but the voxels' faces
    /// Throws InputError that names the value and the rule it breaks.
    void validate() const;
};

/// What tracing gave besides the values.
struct MonteCarloSummary {
    std::uint64_t paths = 0;            ///< in all
    std::uint64_t values = 0;           ///< cells times channels
    std::uint64_t error_too_large = 0;  ///< of them: how many have not reached the wanted standard error
    double largest_error = 0;           ///< standard error
};

}  // namespace voxtone::optics
